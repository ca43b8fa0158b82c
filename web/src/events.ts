// Follows one job: the event stream while the page is visible, slow polling
// while it is hidden (browsers allow six connections to a server over all
// tabs, and a stream holds one for as long as it lives). A lost stream is
// opened again with growing delays; the first event is always a full snapshot,
// so nothing has to be made up for.

import { get_job, job_path, problem_of } from "./api";
import { backoff_ms } from "./backoff";
import { is_final, is_job, type Job } from "./contract";
import { EventParser } from "./event_parser";
import { Problem, unreachable } from "./problem";

/** The server sends a heartbeat at least every 15 s; this much silence means a dead line. */
const kSilenceMs = 40_000;
const kPollMs = 3_000;
/** Polls before a server that had no stream to spare is asked for one again. */
const kPollsBeforeStream = 8;

export interface FollowHandlers {
  on_job(job: Job): void;
  on_live(): void;
  /** The line is down; `retry_at_ms` (Date.now() scale) is the next attempt. */
  on_lost(problem: Problem, retry_at_ms: number): void;
  /** The server said something final, such as 404; nothing is tried again. */
  on_refused(problem: Problem): void;
}

export interface Following {
  stop(): void;
  /** Try at once instead of waiting for the delay to pass. */
  retry_now(): void;
}

export function follow_job(id: string, handlers: FollowHandlers): Following {
  const stopped = new AbortController();
  let attempt = 0;
  let last_id = "";
  let no_stream = false;
  let wake: () => void = () => undefined;

  const receive = (job: Job): void => {
    attempt = 0;
    handlers.on_job(job);
    if (is_final(job.state)) stopped.abort();
  };

  async function stream(signal: AbortSignal): Promise<void> {
    const headers: Record<string, string> = { Accept: "text/event-stream" };
    if (last_id) headers["Last-Event-ID"] = last_id;
    const silence = new AbortController();
    let timer = setTimeout(() => silence.abort(), kSilenceMs);
    try {
      const both = any_signal(signal, silence.signal);
      const answer = await fetch(`${job_path(id)}/events`, { headers, signal: both });
      if (answer.status === 204) return stopped.abort(); // final, and seen
      if (!answer.ok || !answer.body) throw await problem_of(answer);
      handlers.on_live();
      const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
      const parser = new EventParser();
      for (;;) {
        const { done, value } = await reader.read();
        if (done) return;
        clearTimeout(timer);
        timer = setTimeout(() => silence.abort(), kSilenceMs);
        for (const event of parser.feed(value)) {
          last_id = event.id;
          const job = parse_job(event.data);
          if (job) receive(job);
        }
      }
    } finally {
      clearTimeout(timer);
    }
  }

  async function poll(signal: AbortSignal, times: number): Promise<void> {
    for (let turn = 0; turn < times && !signal.aborted; turn += 1) {
      receive(await get_job(id, signal));
      handlers.on_live();
      await pause(kPollMs, signal);
    }
  }

  async function run(): Promise<void> {
    while (!stopped.signal.aborted) {
      const turn = new AbortController();
      const leave = (): void => turn.abort();
      document.addEventListener("visibilitychange", leave, { once: true });
      const signal = any_signal(stopped.signal, turn.signal);
      let problem: Problem = unreachable();
      try {
        if (document.hidden) await poll(signal, Number.POSITIVE_INFINITY);
        else if (no_stream) await poll(signal, kPollsBeforeStream);
        else await stream(signal);
      } catch (error) {
        if (error instanceof Problem) problem = error;
      } finally {
        document.removeEventListener("visibilitychange", leave);
      }
      if (stopped.signal.aborted) return;
      if (turn.signal.aborted) continue; // visibility changed: the other way of following
      if (problem.status >= 400 && problem.status < 500 && problem.status !== 429) {
        handlers.on_refused(problem);
        return;
      }
      no_stream = problem.code === "too_many_streams";
      if (no_stream) continue;
      const delay = Math.max(backoff_ms(attempt, Math.random()), (problem.retry_after ?? 0) * 1000);
      // A line that was merely cut is back with the first retry: no banner for that.
      if (attempt > 0) handlers.on_lost(problem, Date.now() + delay);
      attempt += 1;
      const waiting = new AbortController();
      wake = () => waiting.abort();
      await pause(delay, any_signal(stopped.signal, waiting.signal));
    }
  }

  void run();
  return { stop: () => stopped.abort(), retry_now: () => wake() };
}

function parse_job(data: string): Job | null {
  try {
    const value: unknown = JSON.parse(data);
    return is_job(value) ? value : null;
  } catch {
    return null; // an event of a kind this page does not know
  }
}

/** Resolves after `ms`, or as soon as `signal` aborts. */
export function pause(ms: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => {
    if (signal.aborted) return resolve();
    const timer = setTimeout(resolve, ms);
    signal.addEventListener("abort", () => (clearTimeout(timer), resolve()), { once: true });
  });
}

/** AbortSignal.any, which browsers of 2023 lack. */
export function any_signal(a: AbortSignal, b: AbortSignal): AbortSignal {
  const both = new AbortController();
  for (const one of [a, b]) {
    if (one.aborted) both.abort();
    else one.addEventListener("abort", () => both.abort(), { once: true, signal: both.signal });
  }
  return both.signal;
}
