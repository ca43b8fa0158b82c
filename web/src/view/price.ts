// The control that tells what a smaller error costs, and buys it.

import { is_final, type Job, type JobAccuracy } from "../contract";
import { duration, error_percent } from "../format";
import { error_at, is_reached, kPriceSteps, seconds_left } from "../price";
import { h, set_hidden, set_text } from "./dom";

export class PriceView {
  private target_ = h("input", {
    type: "range", id: "price", min: 0, max: kPriceSteps, step: 1, value: kPriceSteps / 2, "aria-describedby": "price-text",
  });
  private text_ = h("output", { for: "price", id: "price-text" });
  private go_on_ = h("button", { type: "button" }, "Continue to here");
  readonly element = h("section", { class: "price", hidden: true, "aria-label": "Price of accuracy" },
    h("label", { for: "price" }, "Less error"), this.target_, this.text_, this.go_on_);
  private job_: Job | null = null;
  private accuracy_: JobAccuracy | null = null;

  constructor(extend: (job: string, error: number) => void) {
    this.target_.addEventListener("input", () => this.show());
    this.go_on_.addEventListener("click", () => {
      if (this.job_) extend(this.job_.id, this.error());
    });
  }

  update(job: Job, accuracy: JobAccuracy | null): void {
    this.job_ = job;
    this.accuracy_ = accuracy;
    this.show();
  }

  private error(): number {
    return error_at(this.target_.valueAsNumber);
  }

  private show(): void {
    const accuracy = this.accuracy_, job = this.job_;
    const known = accuracy !== null && accuracy.points.length > 0 && job !== null;
    set_hidden(this.element, !known);
    if (!known) return;
    const error = this.error();
    const reached = is_reached(accuracy, error);
    const left = seconds_left(accuracy, error);
    set_text(this.text_, `${error_percent(error)}: ${reached ? "reached" : left ? `${duration(left.low)} to ${duration(left.high)} more` : "unknown"}`);
    set_hidden(this.go_on_, !(is_final(job.state) && job.state === "completed"));
    this.go_on_.disabled = reached;
  }
}
