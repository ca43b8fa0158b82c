// How long to wait before asking a silent server again: doubling with a
// ceiling, and jitter so that many pages do not knock at the same moment.

export const kFirstDelayMs = 500;
export const kLongestDelayMs = 15_000;

/** Delay before attempt `attempt` (0 is the first retry); `random` in [0, 1). */
export function backoff_ms(attempt: number, random: number): number {
  const ceiling = Math.min(kLongestDelayMs, kFirstDelayMs * 2 ** Math.min(attempt, 16));
  return Math.round(ceiling * (0.6 + 0.4 * random));
}
