// What every page shares: the bar, the banner of a lost line, the drop target
// that is the whole page, the help, and the voice for screen readers.

import { files_of_drop } from "../dropped";
import type { State } from "../state";
import { batch_title } from "../contract";
import { BatchList } from "./batch_list";
import { BatchPage } from "./batch_page";
import type { Commands } from "./commands";
import { h, set_attribute, set_hidden, set_text } from "./dom";
import { Help } from "./help";
import { JobForm } from "./job_form";
import { JobList } from "./job_list";
import { JobPage } from "./job_page";
import { UploadPanel } from "./upload_panel";

export class Shell {
  readonly uploads: UploadPanel;
  readonly form: JobForm;
  readonly job: JobPage;
  readonly help = new Help();
  private list_: JobList;
  private batches_ = new BatchList();
  private batch_: BatchPage;
  private home_: HTMLElement;
  private home_title_ = h("h1", { class: "unseen", tabindex: -1 }, "raykiln: renders and jobs");
  private banner_text_ = h("span");
  private banner_: HTMLElement;
  private line_ = h("span", { class: "line" });
  private voice_ = h("div", { class: "unseen", role: "status", "aria-live": "polite" });
  private veil_ = h("div", { class: "veil", hidden: true, "aria-hidden": "true" },
    h("p", {}, "Drop to upload the scene"));

  constructor(root: HTMLElement, commands: Commands) {
    this.uploads = new UploadPanel(commands);
    this.form = new JobForm(commands);
    this.list_ = new JobList(commands);
    this.job = new JobPage(commands);
    this.batch_ = new BatchPage(commands);
    this.home_ = h("main", { class: "page-home", id: "home" }, this.home_title_,
      h("div", { class: "column" }, this.uploads.element,
        h("section", { "aria-labelledby": "form-heading" },
          h("h2", { id: "form-heading" }, "New render"), this.form.element)),
      this.list_.element);
    this.banner_ = h("div", { class: "banner", role: "alert", hidden: true }, this.banner_text_,
      h("button", { type: "button", onclick: () => commands.retry_now() }, "Try now"));
    const question = h("button",
      { type: "button", class: "quiet", "aria-label": "Keyboard shortcuts", title: "Keyboard shortcuts (?)",
        onclick: () => this.help.open() }, "?");
    root.replaceChildren(
      h("a", { class: "skip", href: "#home" }, "Skip to the content"),
      h("header", { class: "bar" },
        h("a", { class: "brand", href: "/" }, h("span", { class: "ember", "aria-hidden": "true" }), "raykiln"),
        h("nav", { "aria-label": "Main" }, h("a", { href: "/" }, "Jobs"), h("a", { href: "/batches" }, "Batches"), h("a", { href: "/openapi.yaml" }, "API")), this.line_, question),
      this.banner_, this.home_, this.job.element, this.batches_.element, this.batch_.element, this.voice_, this.veil_, this.help.element);
    this.listen(root, commands);
  }

  private listen(root: HTMLElement, commands: Commands): void {
    let depth = 0; // dragenter and dragleave come for every element on the way
    const carries_files = (event: DragEvent): boolean =>
      event.dataTransfer?.types.includes("Files") ?? false;
    window.addEventListener("dragenter", (event) => {
      if (!carries_files(event)) return;
      depth += 1;
      set_hidden(this.veil_, false);
    });
    window.addEventListener("dragleave", (event) => {
      if (!carries_files(event)) return;
      depth = Math.max(0, depth - 1);
      set_hidden(this.veil_, depth > 0 ? this.veil_.hidden : true);
    });
    window.addEventListener("dragover", (event) => {
      if (carries_files(event)) event.preventDefault();
    });
    window.addEventListener("drop", (event) => {
      if (!event.dataTransfer || !carries_files(event)) return;
      event.preventDefault();
      depth = 0;
      set_hidden(this.veil_, true);
      commands.upload(files_of_drop(event.dataTransfer));
    });
    root.addEventListener("click", (event) => {
      const link = (event.target as Element).closest("a");
      const plain = event.button === 0 && !event.metaKey && !event.ctrlKey && !event.shiftKey;
      if (!link || !plain || link.hasAttribute("download") || link.origin !== location.origin) return;
      const skip = link.classList.contains("skip");
      if (!skip && !/^\/($|jobs\/|batches($|\/))/.test(link.pathname)) return;
      event.preventDefault();
      if (skip) this.focus_page();
      else commands.navigate(link.pathname);
    });
  }

  /** Moves the focus to the page's heading, after a change of place. */
  focus_page(): void {
    const places = [this.home_, this.job.element, this.batches_.element, this.batch_.element];
    const titles = [this.home_title_, this.job, this.batches_, this.batch_];
    titles[places.findIndex((place) => !place.hidden)]?.focus();
  }

  say(text: string): void {
    set_text(this.voice_, text);
  }

  update(state: State): void {
    const { route } = state;
    set_hidden(this.home_, route.page !== "home");
    set_hidden(this.job.element, route.page !== "job");
    set_hidden(this.batches_.element, route.page !== "batches");
    set_hidden(this.batch_.element, route.page !== "batch");
    const lost = state.line.state === "lost";
    set_hidden(this.banner_, !lost);
    if (lost) {
      const wait = Math.max(0, Math.ceil((state.line.retry_at_ms - state.now_ms) / 1000));
      // The seconds stand in an attribute that CSS shows: a screen reader hears the alert once.
      set_text(this.banner_text_, `${state.line.reason} What you see is the last that was known.`);
      set_attribute(this.banner_text_, "data-wait", wait > 0 ? ` Next try in ${wait} s.` : " Trying…");
    }
    set_attribute(this.line_, "data-line", state.line.state);
    set_text(this.line_, { connecting: "connecting", live: "live", lost: "offline", ended: "" }[state.line.state]);
    if (route.page === "job") {
      this.job.update(state, route.id);
    } else if (route.page === "batches") {
      this.batches_.update(state);
    } else if (route.page === "batch") {
      this.batch_.update(state, route.id);
    } else {
      this.uploads.update(state.uploads);
      this.form.update(state);
      this.list_.update(state);
    }
    document.title = title(state);
  }
}

function title(state: State): string {
  if (state.route.page === "batches") return "Batches · raykiln";
  if (state.route.page === "batch") {
    return state.batch ? `${state.batch.state} · ${batch_title(state.batch)} · raykiln` : "raykiln";
  }
  if (state.route.page !== "job") return "raykiln";
  const job = state.jobs[state.route.id];
  if (!job) return "raykiln";
  const name = job.name || state.scenes[job.scene]?.name || job.id.slice(0, 10);
  const what = job.state === "rendering" ? `${Math.floor(job.progress.fraction * 100)} %` : job.state;
  return `${what} · ${name} · raykiln`;
}
