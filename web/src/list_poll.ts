// Keeps what is on screen fresh by asking again: often while something
// runs, seldom otherwise, not at all in a hidden tab.

import { backoff_ms } from "./backoff";
import { any_signal, pause } from "./events";
import { Problem } from "./problem";

const kBusyMs = 1000;
const kIdleMs = 4000;

export interface PollHandlers<Page> {
  ask(signal: AbortSignal): Promise<Page>;
  on_page(page: Page): void;
  on_lost(problem: Problem, retry_at_ms: number): void;
  /** The server said something final, such as 404; nothing is asked again. */
  on_refused?(problem: Problem): void;
  is_busy(): boolean;
}

export function poll<Page>(handlers: PollHandlers<Page>): { stop(): void; now(): void } {
  const stopped = new AbortController();
  let waiting = new AbortController();
  const now = (): void => waiting.abort();
  const on_visible = (): void => {
    if (!document.hidden) now();
  };
  document.addEventListener("visibilitychange", on_visible, { signal: stopped.signal });

  async function run(): Promise<void> {
    let attempt = 0;
    while (!stopped.signal.aborted) {
      let delay = handlers.is_busy() ? kBusyMs : kIdleMs;
      try {
        const page = await handlers.ask(stopped.signal);
        if (stopped.signal.aborted) return;
        handlers.on_page(page);
        attempt = 0;
        delay = handlers.is_busy() ? kBusyMs : kIdleMs;
      } catch (error) {
        if (stopped.signal.aborted) return;
        if (!(error instanceof Problem)) throw error;
        if (error.status === 404 && handlers.on_refused) return handlers.on_refused(error);
        delay = Math.max(backoff_ms(attempt, Math.random()), (error.retry_after ?? 0) * 1000);
        if (attempt > 0) handlers.on_lost(error, Date.now() + delay);
        attempt += 1;
      }
      if (document.hidden) delay = 3_600_000; // until the tab is visible again
      waiting = new AbortController();
      await pause(delay, any_signal(stopped.signal, waiting.signal));
    }
  }

  void run();
  return { stop: () => stopped.abort(), now };
}
