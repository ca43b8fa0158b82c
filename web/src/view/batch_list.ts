// The list of batches: a row each, with its counts.

import { batch_title, type BatchSummary } from "../contract";
import { ago } from "../format";
import type { State } from "../state";
import { h, set_attribute, set_children, set_hidden, set_text } from "./dom";

/** "5 of 6 done, 1 failed, 2 reused" */
export function counts_text({ counts }: BatchSummary): string {
  const parts = [`${counts.completed} of ${counts.total} done`];
  for (const state of ["active", "waiting", "failed", "cancelled", "skipped", "reused"] as const) {
    if (counts[state] > 0) parts.push(`${counts[state]} ${state}`);
  }
  return parts.join(", ");
}

export const chip_state = (state: string): string =>
  ({ running: "rendering", active: "rendering", waiting: "queued", skipped: "cancelled" })[state] ?? state;

class Row {
  private title_ = h("a");
  private chip_ = h("span", { class: "chip" });
  private counts_ = h("span");
  private when_ = h("span", { class: "hint" });
  readonly element = h("li", { class: "batch-row" }, this.title_, this.chip_, this.counts_, this.when_);

  update(batch: BatchSummary, now_ms: number): void {
    set_attribute(this.title_, "href", `/batches/${encodeURIComponent(batch.id)}`);
    set_text(this.title_, batch_title(batch));
    set_text(this.chip_, batch.state);
    set_attribute(this.chip_, "data-state", chip_state(batch.state));
    set_text(this.counts_, counts_text(batch));
    set_text(this.when_, ago(batch.finished_at ?? batch.created_at, now_ms));
  }
}

export class BatchList {
  private rows_ = new Map<string, Row>();
  private title_ = h("h1", { tabindex: -1 }, "Batches");
  private empty_ = h("p", { class: "empty" });
  private list_ = h("ul", { class: "batch-rows" });
  readonly element = h("main", { class: "page-batch", hidden: true }, this.title_, this.empty_, this.list_);

  focus(): void {
    this.title_.focus();
  }

  update(state: State): void {
    const batches = state.batches ?? [];
    set_children(this.list_, batches.map((batch) => {
      const row = this.rows_.get(batch.id) ?? new Row();
      this.rows_.set(batch.id, row);
      row.update(batch, state.now_ms);
      return row.element;
    }));
    set_text(this.empty_, state.batches ? "No batches yet. raykiln batch FILE sends one." : "Loading…");
    set_hidden(this.empty_, batches.length > 0);
  }
}
