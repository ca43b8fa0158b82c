// What less error costs: between the errors that the server has priced, along a line in the log-log plot. No DOM here.

import type { JobAccuracy, SecondsRange } from "./contract";

/** Positions of the control, from rough to exact, evenly spaced in the logarithm. */
export const kPriceSteps = 30;
const kRough = 0.1, kExact = 0.005;

export const error_at = (step: number): number => {
  const exact = kRough * (kExact / kRough) ** (step / kPriceSteps);
  return Number(exact.toPrecision(2));
};

/** Render seconds from now on; null where nothing is known. */
export function seconds_left(accuracy: JobAccuracy, error: number): SecondsRange | null {
  const prices = accuracy.prices.filter((price) => price.seconds !== null).sort((a, b) => b.error - a.error);
  const rough = prices.filter((price) => price.error >= error).at(-1);
  const exact = prices.find((price) => price.error <= error);
  if (!rough?.seconds || !exact?.seconds) return null;
  const share = rough.error === exact.error ? 0 : Math.log(error / rough.error) / Math.log(exact.error / rough.error);
  const now = accuracy.points.at(-1)?.render_seconds ?? 0;
  const left = (of: keyof SecondsRange): number => {
    const from = rough.seconds?.[of] ?? 0, to = exact.seconds?.[of] ?? 0;
    if (!(from > 0 && to > 0)) return 0;
    return Math.max(0, from * (to / from) ** share - now);
  };
  return { value: left("value"), low: left("low"), high: left("high") };
}

/** Whether the picture is as exact already. */
export const is_reached = (accuracy: JobAccuracy, error: number): boolean => {
  const last = accuracy.points.at(-1)?.error;
  return last !== null && last !== undefined && last.high <= error;
};
