// What a screen reader hears of a job: every change of state, and progress in
// quarters. Progress between is on screen, and would only interrupt.

import type { Job } from "./contract";
import { duration, percent } from "./format";

const quarter = (job: Job): number => Math.floor(job.progress.fraction * 4);

/** The sentence for the step from `before` to `now`; empty for silence. */
export function announcement(before: Job | undefined, now: Job): string {
  if (!before || before.id !== now.id) return state_sentence(now);
  if (before.state !== now.state) return state_sentence(now);
  if (now.state === "rendering" && quarter(now) > quarter(before)) {
    const left = now.remaining_seconds;
    const rest = left === null ? "" : `, ${duration(left)} left`;
    return `${percent(quarter(now) / 4)} rendered${rest}`;
  }
  return "";
}

function state_sentence(job: Job): string {
  switch (job.state) {
    case "completed": return `Render completed in ${duration(job.elapsed_seconds)}`;
    case "failed": return `Render failed: ${job.error?.detail || job.error?.title || "no reason given"}`;
    case "cancelled": return "Render cancelled";
    case "cancelling": return "Cancelling";
    case "queued": return "Waiting in the queue";
    case "preparing": return "Preparing the scene";
    case "rendering": return `Rendering, ${percent(job.progress.fraction)}`;
  }
}
