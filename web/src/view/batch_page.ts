// One batch: its counts, what can be done, and its pictures with links to their jobs.

import { batch_title, type BatchItem } from "../contract";
import type { State } from "../state";
import { chip_state, counts_text } from "./batch_list";
import type { Commands } from "./commands";
import { h, set_attribute, set_children, set_hidden, set_text } from "./dom";

class Row {
  private link_ = h("a");
  private plain_ = h("span");
  private chip_ = h("span", { class: "chip" });
  private why_ = h("span", { class: "problem" });
  readonly element = h("li", { class: "batch-row" }, this.link_, this.plain_, this.chip_, this.why_);

  update(item: BatchItem): void {
    set_hidden(this.link_, item.job === null);
    set_hidden(this.plain_, item.job !== null);
    set_text(this.link_, item.name);
    set_text(this.plain_, item.name);
    set_attribute(this.link_, "href", item.job === null ? null : `/jobs/${encodeURIComponent(item.job)}`);
    set_text(this.chip_, item.reused ? `${item.state}, reused` : item.state);
    set_attribute(this.chip_, "data-state", chip_state(item.state));
    set_text(this.why_, item.error ? [item.error.detail, item.error.where].filter(Boolean).join(": ") : "");
  }
}

export class BatchPage {
  private rows_ = new Map<string, Row>();
  private of_ = "";
  private title_ = h("h1", { tabindex: -1 });
  private chip_ = h("span", { class: "chip" });
  private counts_ = h("p");
  private bar_ = h("progress", { max: 1, value: 0, "aria-label": "Pictures that have ended" });
  private problem_ = h("p", { class: "problem", role: "alert", hidden: true });
  private cancel_ = h("button", { type: "button", class: "danger" }, "Cancel the batch");
  private rerun_ = h("button", { type: "button" }, "Run again what failed");
  private list_ = h("ul", { class: "batch-rows" });
  readonly element = h("main", { class: "page-batch", hidden: true }, h("p", {}, h("a", { href: "/batches" }, "All batches")),
    this.title_, this.chip_, this.counts_, this.bar_, this.problem_,
    h("div", { class: "row" }, this.cancel_, this.rerun_), this.list_);

  constructor(commands: Commands) {
    this.cancel_.addEventListener("click", () => commands.command_batch(this.of_, "cancel"));
    this.rerun_.addEventListener("click", () => commands.command_batch(this.of_, "rerun"));
  }

  focus(): void {
    this.title_.focus();
  }

  update(state: State, id: string): void {
    if (this.of_ !== id) this.rows_.clear();
    this.of_ = id;
    const batch = state.batch;
    const text = state.missing || state.command_problem;
    set_text(this.problem_, text);
    set_hidden(this.problem_, text === "");
    for (const part of [this.chip_, this.counts_, this.bar_]) set_hidden(part, batch === null);
    set_hidden(this.cancel_, batch?.state !== "running");
    set_hidden(this.rerun_, batch === null || batch.state === "running" || batch.state === "completed");
    set_text(this.title_, batch ? batch_title(batch) : state.missing ? "No such batch" : "Loading…");
    set_children(this.list_, (batch?.items ?? []).map((item) => {
      const row = this.rows_.get(item.name) ?? new Row();
      this.rows_.set(item.name, row);
      row.update(item);
      return row.element;
    }));
    if (!batch) return;
    set_text(this.chip_, batch.state);
    set_attribute(this.chip_, "data-state", chip_state(batch.state));
    set_text(this.counts_, counts_text(batch));
    const ended = batch.counts.total - batch.counts.waiting - batch.counts.active;
    this.bar_.value = ended / Math.max(1, batch.counts.total);
  }
}
