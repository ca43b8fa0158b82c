// The list of jobs: a card each, with a thumbnail that follows the render.

import { image_url } from "../api";
import { is_final, job_title, type Job } from "../contract";
import { ago, count, duration, percent } from "../format";
import { jobs_in_order, since_heard, type State } from "../state";
import type { Commands } from "./commands";
import { h, set_attribute, set_children, set_hidden, set_text } from "./dom";

/** A running job's thumbnail is fetched at most this often. */
const kThumbnailMs = 2500;

class JobCard {
  private picture_ = h("img", { alt: "", loading: "lazy", decoding: "async", hidden: true });
  private instead_ = h("span", { class: "thumb-text" });
  private title_ = h("span", { class: "card-title" });
  private chip_ = h("span", { class: "chip" });
  private meta_ = h("span", { class: "card-meta" });
  private bar_ = h("progress", { max: 1, value: 0, "aria-hidden": "true" });
  private link_ = h("a", { class: "card" },
    h("span", { class: "thumb" }, this.instead_, this.picture_),
    h("span", { class: "card-text" }, this.title_, this.chip_, this.meta_), this.bar_);
  readonly element = h("li", {}, this.link_);
  private fetched_ms_ = 0;
  private loading_ = false;

  constructor() {
    const settle = (shown: boolean) => (): void => {
      this.loading_ = false;
      set_hidden(this.picture_, !shown);
    };
    this.picture_.addEventListener("load", settle(true));
    this.picture_.addEventListener("error", settle(false));
  }

  update(state: State, job: Job): void {
    const scene = state.scenes[job.scene];
    set_attribute(this.link_, "href", `/jobs/${encodeURIComponent(job.id)}`);
    set_text(this.title_, job_title(job, scene));
    set_text(this.chip_, chip_text(job));
    set_attribute(this.chip_, "data-state", job.state);
    set_text(this.meta_, meta(state, job));
    const fraction = job.state === "preparing" ? (job.prepare?.fraction ?? 0) : job.progress.fraction;
    if (this.bar_.value !== fraction) this.bar_.value = fraction;
    set_hidden(this.bar_, is_final(job.state) || job.state === "queued");
    set_text(this.instead_, job.image ? "" : is_final(job.state) ? "No picture" : "No picture yet");
    this.thumbnail(state, job);
  }

  private thumbnail(state: State, job: Job): void {
    if (!job.image || this.loading_) return;
    const address = image_url(job.id, "png", 0, job.image.revision);
    if (this.picture_.getAttribute("src") === address) return;
    if (!is_final(job.state) && state.now_ms - this.fetched_ms_ < kThumbnailMs) return;
    this.fetched_ms_ = state.now_ms;
    this.loading_ = true;
    // loading=lazy does not load what is hidden; the box keeps its size without the picture.
    set_hidden(this.picture_, false);
    this.picture_.src = address;
  }
}

function chip_text(job: Job): string {
  return job.state === "rendering" ? `rendering ${percent(job.progress.fraction)}` : job.state;
}

function meta(state: State, job: Job): string {
  const { width, height } = job.request;
  const parts = [`${width} × ${height}`, `${count(job.progress.samples_target)} spp`];
  if (job.effects?.approximation) parts.push("approximation");
  if (job.state === "queued" && job.queue_position) parts.push(`${job.queue_position} ahead`);
  else if (is_final(job.state)) {
    if (job.started_at) parts.push(duration(job.elapsed_seconds));
    parts.push(ago(job.finished_at ?? job.created_at, state.now_ms));
  } else if (job.remaining_seconds !== null) {
    const left = Math.max(0, job.remaining_seconds - since_heard(state, job));
    parts.push(`${duration(left)} left`);
  }
  return parts.join(" · ");
}

export class JobList {
  private cards_ = new Map<string, JobCard>();
  private list_ = h("ul", { class: "cards" });
  private empty_ = h("p", { class: "empty" });
  private older_ = h("button", { type: "button", class: "quiet" }, "Show older jobs");
  readonly element = h("section", { class: "jobs", "aria-labelledby": "jobs-heading" },
    h("h2", { id: "jobs-heading" }, "Jobs"), this.empty_, this.list_, this.older_);

  constructor(commands: Commands) {
    this.older_.addEventListener("click", () => commands.show_older());
  }

  update(state: State): void {
    const jobs = jobs_in_order(state);
    const elements = jobs.map((job) => {
      const card = this.cards_.get(job.id) ?? new JobCard();
      this.cards_.set(job.id, card);
      card.update(state, job);
      return card.element;
    });
    set_children(this.list_, elements);
    set_text(this.empty_, state.jobs_loaded
      ? "Nothing rendered yet. Drop a scene on this page to begin."
      : "Loading…");
    set_hidden(this.empty_, jobs.length > 0);
    set_hidden(this.older_, state.older_cursor === null);
  }
}
