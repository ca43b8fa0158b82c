// One job: its picture, its figures, and what can be done with it.

import { image_url } from "../api";
import { is_final, job_title, layers_of, type Job, type Layer } from "../contract";
import { count, duration, error_percent, label_of, percent, ray_rate, si, statistic, stops } from "../format";
import { effects_text } from "../form";
import { remedy_of } from "../problem";
import { since_heard, type State } from "../state";
import type { Commands } from "./commands";
import { CurveView } from "./curve";
import { Facts, h, set_attribute, set_hidden, set_text } from "./dom";
import { EffectList } from "./effects";
import { report } from "./job_form";
import { kLayerNames, legend } from "./layers";
import { Picture } from "./picture";
import { PriceView } from "./price";
import { WarningList } from "./warnings";

export const kExposureRange = { min: -8, max: 8, step: 0.1 };

export class JobPage {
  readonly picture = new Picture();
  private title_ = h("h1", { tabindex: -1 });
  private chip_ = h("span", { class: "chip" });
  private bar_ = h("progress", { max: 1, value: 0, "aria-label": "Progress", "aria-describedby": "progress-text" });
  private bar_text_ = h("span", { id: "progress-text" });
  private figures_ = new Facts();
  private failure_ = h("section", { class: "failure", role: "alert", hidden: true });
  private warnings_ = new WarningList();
  private command_problem_ = h("p", { class: "problem", role: "alert", hidden: true });
  private cancel_ = h("button", { type: "button", class: "danger" }, "Cancel");
  private again_ = h("button", { type: "button" }, "Render again");
  private png_ = h("a", { class: "button" }, "PNG");
  private exr_ = h("a", { class: "button" }, "EXR");
  private downloads_ = h("div", { class: "row downloads", role: "group", "aria-label": "Download" },
    h("span", { class: "hint" }, "Download"), this.png_, this.exr_);
  private exposure_ = h("input", {
    type: "range", id: "exposure", ...kExposureRange, "aria-describedby": "exposure-value",
  });
  private exposure_value_ = h("output", { for: "exposure", id: "exposure-value" });
  private reset_ = h("button", { type: "button", class: "quiet" }, "Reset");
  private fit_ = h("button", { type: "button", "aria-pressed": "true" }, "Fit");
  private actual_ = h("button", { type: "button", "aria-pressed": "false" }, "100 %");
  private layer_ = h("select", { id: "layer" });
  private layers_ = "";
  private legend_bar_ = h("span", { class: "legend-bar" });
  private legend_text_ = h("span", { class: "hint" });
  private legend_ = h("div", { class: "legend", hidden: true }, this.legend_bar_, this.legend_text_);
  private curve_ = new CurveView();
  private price_: PriceView;
  private scale_ = h("span", { class: "hint scale" });
  private statistics_ = new Facts();
  private effects_ = new EffectList();
  private approximation_ = h("span", { class: "mark", hidden: true }, "approximation");
  private settings_ = new Facts();
  private scene_ = new Facts();
  private content_ = h("div", { class: "job" });
  private missing_ = h("div", { class: "missing", hidden: true });
  private missing_text_ = h("p");
  readonly element = h("main", { class: "page-job", id: "job" }, this.missing_, this.content_);
  private id_ = "";

  constructor(commands: Commands) {
    this.price_ = new PriceView((job, error) => commands.extend(job, error));
    this.cancel_.addEventListener("click", () => commands.cancel(this.id_));
    this.again_.addEventListener("click", () => commands.render_again(this.id_));
    this.exposure_.addEventListener("input", () => commands.set_exposure(this.exposure_.valueAsNumber));
    this.reset_.addEventListener("click", () => commands.set_exposure(0));
    this.layer_.addEventListener("change", () => commands.set_layer(this.layer_.value as Layer));
    this.fit_.addEventListener("click", () => commands.set_zoom("fit"));
    this.actual_.addEventListener("click", () => commands.set_zoom("actual"));
    this.picture.on_scale = (scale) => set_text(this.scale_, percent_scale(scale));
    this.missing_.append(h("h1", {}, "No such job"), this.missing_text_,
      h("p", {}, h("a", { href: "/" }, "Back to all jobs")));
    this.content_.append(this.viewer(), this.panel());
  }

  private viewer(): HTMLElement {
    return h("section", { class: "viewer", "aria-label": "Viewer" }, this.picture.stage,
      h("div", { class: "toolbar" },
        h("div", { class: "exposure" },
          h("label", { for: "exposure" }, "Exposure"), this.exposure_, this.exposure_value_, this.reset_),
        h("div", { class: "layer" }, h("label", { for: "layer" }, "Show"), this.layer_, this.legend_),
        h("div", { class: "row", role: "group", "aria-label": "Zoom" },
          this.fit_, this.actual_, this.scale_)));
  }

  private panel(): HTMLElement {
    const fold = (name: string, facts: Facts, open: boolean): HTMLElement =>
      h("details", { open }, h("summary", {}, name), facts.element);
    return h("aside", { class: "panel", "aria-label": "Job" },
      h("header", {}, this.title_, this.chip_, this.approximation_),
      h("div", { class: "meter" }, this.bar_, this.bar_text_),
      this.failure_, this.figures_.element,
      h("div", { class: "row actions" }, this.cancel_, this.again_),
      this.command_problem_, this.downloads_, this.warnings_.element,
      this.curve_.element, this.price_.element,
      fold("Statistics", this.statistics_, true),
      this.effects_.element,
      fold("Settings", this.settings_, false),
      fold("Scene", this.scene_, false));
  }

  focus(): void {
    this.title_.focus();
  }

  /** Follows a shortcut as if its button had been pressed; hidden buttons do nothing. */
  press(which: "cancel" | "again" | "png" | "exr"): void {
    const target = { cancel: this.cancel_, again: this.again_, png: this.png_, exr: this.exr_ }[which];
    if (target.offsetParent !== null) target.click();
  }

  update(state: State, id: string): void {
    const job = state.jobs[id];
    this.id_ = id;
    set_hidden(this.missing_, state.missing === "");
    set_hidden(this.content_, state.missing !== "");
    set_text(this.missing_text_, state.missing);
    this.exposure_.value = String(state.exposure);
    set_text(this.exposure_value_, stops(state.exposure));
    this.reset_.disabled = state.exposure === 0;
    this.offer(job ? layers_of(job.request) : ["beauty"]);
    if (this.layer_.value !== state.layer) this.layer_.value = state.layer;
    const range = state.layer === "beauty" ? null : state.range;
    const said = legend(state.layer, range);
    set_hidden(this.legend_, said === "");
    set_hidden(this.legend_bar_, range === null);
    set_text(this.legend_text_, said);
    this.curve_.update(state.accuracy);
    set_attribute(this.fit_, "aria-pressed", String(state.zoom === "fit"));
    set_attribute(this.actual_, "aria-pressed", String(state.zoom === "actual"));
    this.picture.set_zoom(state.zoom);
    set_text(this.command_problem_, state.command_problem);
    set_hidden(this.command_problem_, state.command_problem === "");
    if (job) this.price_.update(job, state.accuracy);
    if (job) this.show(state, job);
    else this.wait(id);
  }

  private offer(layers: readonly Layer[]): void {
    if (layers.join() === this.layers_) return;
    this.layers_ = layers.join();
    this.layer_.replaceChildren(...layers.map((layer) => h("option", { value: layer }, kLayerNames[layer])));
  }

  private wait(id: string): void {
    set_text(this.title_, `Job ${id.slice(0, 10)}`);
    set_text(this.chip_, "loading");
    set_attribute(this.chip_, "data-state", "loading");
    this.picture.describe("No picture yet", "Loading…");
    for (const element of [this.cancel_, this.again_, this.downloads_]) set_hidden(element, true);
  }

  private show(state: State, job: Job): void {
    const title = job_title(job, state.scenes[job.scene]);
    set_text(this.title_, title);
    set_text(this.chip_, job.state);
    set_attribute(this.chip_, "data-state", job.state);
    this.picture.expect(job.request.width, job.request.height);
    const approximation = job.effects?.approximation === true;
    this.picture.describe(
      `Picture of ${title}, ${percent(job.progress.fraction)} rendered${approximation ? ", deliberate approximation" : ""}`,
      waiting_text(job));
    set_hidden(this.approximation_, !approximation);
    this.effects_.update(job.effects);
    this.meter(job);
    this.figures_.update(figures(state, job));
    this.failure(job);
    this.warnings_.update(job.warnings);
    set_hidden(this.cancel_, is_final(job.state));
    this.cancel_.disabled = job.state === "cancelling";
    set_text(this.cancel_, job.state === "cancelling" ? "Cancelling…" : "Cancel");
    set_hidden(this.again_, false);
    this.download_links(state, job, title);
    const replays = replay_rows(job);
    this.statistics_.update([...statistic_rows(job), ...replays], replays.map(([name]) => name));
    this.settings_.update(setting_rows(job));
    const scene = state.scenes[job.scene];
    this.scene_.update(scene ? report(scene) : [["Id", job.scene.slice(0, 16)]]);
  }

  private meter(job: Job): void {
    const preparing = job.state === "preparing";
    const fraction = preparing ? (job.prepare?.fraction ?? 0) : job.progress.fraction;
    if (job.state === "queued") this.bar_.removeAttribute("value");
    else if (this.bar_.value !== fraction || !this.bar_.hasAttribute("value")) this.bar_.value = fraction;
    set_attribute(this.bar_, "data-state", job.state);
    set_text(this.bar_text_, meter_text(job));
  }

  private failure(job: Job): void {
    set_hidden(this.failure_, !job.error);
    if (!job.error) return;
    const text = `${job.error.where ? `${job.error.where}: ` : ""}${job.error.detail || job.error.title}`;
    if (this.failure_.dataset["text"] === text) return;
    this.failure_.dataset["text"] = text;
    this.failure_.replaceChildren(h("h2", {}, "The render failed"), h("p", {}, text),
      h("p", { class: "hint" }, remedy_of(job.error.code) || "Change the settings and render again."));
  }

  private download_links(state: State, job: Job, title: string): void {
    set_hidden(this.downloads_, !job.image);
    const partial = job.state === "completed" ? "" : "-partial";
    const name = `${title.replace(/[^\p{L}\p{N}._-]+/gu, "-")}${partial}`;
    set_attribute(this.png_, "href", image_url(job.id, "png", state.exposure));
    set_attribute(this.png_, "download", `${name}.png`);
    set_attribute(this.exr_, "href", image_url(job.id, "exr"));
    set_attribute(this.exr_, "download", `${name}.exr`);
  }
}

const percent_scale = (scale: number): string => `${Math.round(scale * 100)} %`;

function waiting_text(job: Job): string {
  if (job.image) return "";
  if (job.state === "queued") return "Waiting in the queue";
  if (job.state === "preparing") return "Preparing the scene";
  return is_final(job.state) ? "No picture was made" : "The first picture is on its way";
}

function meter_text(job: Job): string {
  switch (job.state) {
    case "queued":
      if (job.queue_position === null) return "In the queue";
      return job.queue_position === 0 ? "Next in the queue" : `${job.queue_position} jobs start before this one`;
    case "preparing":
      return preparing_text(job);
    case "completed":
      return `Done in ${duration(job.elapsed_seconds)}`;
    case "cancelled":
      return job.image ? `Stopped at ${percent(job.progress.fraction)}; the partial picture is kept` : "Stopped before it began";
    case "failed":
      return `Failed at ${percent(job.progress.fraction)}`;
    default:
      return percent(job.progress.fraction);
  }
}

const kStages: Record<string, string> = {
  waiting: "Waiting for the scene", importing: "Reading the scene", building: "Building the tree",
};

function preparing_text(job: Job): string {
  if (!job.prepare) return "Preparing";
  const { stage, fraction } = job.prepare;
  return `${kStages[stage] ?? stage} · ${percent(fraction)}`;
}

function figures(state: State, job: Job): [string, string][] {
  const since = since_heard(state, job);
  const rows: [string, string][] = [["Elapsed", duration(job.elapsed_seconds + since)]];
  if (!is_final(job.state)) {
    const left = job.remaining_seconds;
    rows.push(["Remaining", left === null ? "–" : duration(Math.max(0, left - since))]);
  }
  const { samples_done, samples_target, tiles_done, tiles_total } = job.progress;
  const done = samples_done >= 10 || Number.isInteger(samples_done) ? count(samples_done) : samples_done.toFixed(1);
  const { error, seconds } = job.request.stop;
  const bounded = error === undefined && seconds === undefined;
  rows.push(["Samples", bounded ? `${done} / ${count(samples_target)}` : done]);
  rows.push(...accuracy_rows(job));
  rows.push(["Tiles done", `${count(tiles_done)} / ${count(tiles_total)}`]);
  const rate = job.statistics["rays_per_second"];
  rows.push(["Speed", ray_rate(typeof rate === "number" && rate > 0 ? rate : null)]);
  const rays = job.statistics["rays"];
  rows.push(["Rays", si(typeof rays === "number" ? rays : null)]);
  return rows;
}

const kStopNames = { samples: "samples", seconds: "the time limit", error: "the error target" };

function accuracy_rows(job: Job): [string, string][] {
  const accuracy = job.accuracy;
  if (!accuracy) return [];
  const rows: [string, string][] = [];
  const figure = accuracy.error;
  rows.push(["Error", figure ? `${error_percent(figure.value)} (${error_percent(figure.low)} to ${error_percent(figure.high)})` : "unknown"]);
  if (accuracy.target !== null) {
    const reached = accuracy.target_reached ? "reached" : is_final(job.state) ? "not reached" : "not yet";
    rows.push(["Target", `${error_percent(accuracy.target)}, ${reached}`]);
  }
  if (accuracy.remarks.length > 0) rows.push(["Mind", accuracy.remarks.join("; ")]);
  if (job.done_by) rows.push(["Ended by", kStopNames[job.done_by]]);
  return rows;
}

const kElsewhere = ["rays_per_second", "rays"];

function statistic_rows(job: Job): [string, string][] {
  const rows: [string, string][] = [];
  for (const [key, value] of Object.entries(job.statistics ?? {})) {
    if (kElsewhere.includes(key) || (typeof value === "object" && value !== null)) continue;
    rows.push([label_of(key), statistic(key, value)]);
  }
  return rows;
}

/** The commands that render the samples again that were not finite. */
function replay_rows(job: Job): [string, string][] {
  const list = job.statistics?.["bad_samples"];
  if (!Array.isArray(list)) return [];
  return list.map((bad: { replay?: unknown }, i) => [`Replay bad sample ${i + 1}`, String(bad.replay ?? "")]);
}

function setting_rows(job: Job): [string, string][] {
  const { stop, scene: _scene, camera, name: _name, light_model_overrides: overrides, effects, layers, lens, crop, tree, ...rest } = job.request;
  const rows: [string, string][] = [];
  if (stop.samples !== undefined) rows.push(["Samples at most", count(stop.samples)]);
  if (stop.error !== undefined) rows.push(["Error target", error_percent(stop.error)]);
  if (stop.seconds !== undefined) rows.push(["Time limit", duration(stop.seconds)]);
  rows.push(["Camera", typeof camera === "object" ? "own" : String(camera ?? 0)]);
  for (const [key, value] of Object.entries(overrides ?? {})) rows.push([label_of(key), statistic(key, value)]);
  for (const [key, value] of Object.entries(rest)) rows.push([label_of(key), statistic(key === "seed" ? "" : key, value)]);
  if (lens) rows.push(["Lens", `radius ${lens.radius} m, focus at ${lens.focus_distance ?? 1} m`]);
  if (crop) rows.push(["Window", `at ${crop.x}, ${crop.y} of ${crop.full_width} × ${crop.full_height}`]);
  if (tree?.references_per_triangle !== undefined) rows.push(["Tree references at most", `${tree.references_per_triangle} a triangle`]);
  if (tree?.max_bytes !== undefined) rows.push(["Tree memory at most", statistic("bytes", tree.max_bytes)]);
  if (layers && layers.length > 0) rows.push(["Layers", layers.map(label_of).join(", ")]);
  if (effects !== undefined) rows.push(["Effects", effects_text(effects)]);
  rows.push(["Job", job.id]);
  if (job.continues) rows.push(["Continues", `${job.continues.job}, ${count(job.continues.samples)} samples taken over`]);
  return rows;
}
