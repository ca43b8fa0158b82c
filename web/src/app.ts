// Connects the parts: commands and server events become actions, the state
// moves, the view follows. All effects of the page are started here.

import { announcement } from "./announce";
import * as api from "./api";
import { is_final, type Batch, type Job, type Layer } from "./contract";
import { follow_job, type Following } from "./events";
import { check_form, from_job, place_errors, to_request, type FormKey } from "./form";
import { ImageFeed } from "./image";
import { shortcut, type Shortcut } from "./keys";
import { poll, type PollHandlers } from "./list_poll";
import { explain, Problem } from "./problem";
import { parse_route, route_path, same_route, type Route } from "./route";
import { initial_state, reduce, type Action, type State } from "./state";
import { plan_uploads, type SceneFile, type UploadPlan } from "./upload_list";
import type { Commands } from "./view/commands";
import { kExposureRange } from "./view/job_page";
import { Shell } from "./view/shell";

const kExposureSettleMs = 120;
const kAccuracyPaceMs = 2000;

export class App implements Commands {
  private state_: State;
  private shell_: Shell;
  private image_: ImageFeed;
  private following_: Following | null = null;
  private poll_: { stop(): void; now(): void } | null = null;
  private uploading_ = new Map<number, api.UploadHandle>();
  private next_upload_ = 1;
  private drawing_ = false;
  private exposure_timer_ = 0;
  private accuracy_asked_ms_ = Number.NEGATIVE_INFINITY;
  /** A deleted scene is asked for once, not with every event of its job. */
  private asked_scenes_ = new Set<string>();
  private submission_ = { body: "", key: "" };

  constructor(root: HTMLElement) {
    this.state_ = initial_state(parse_route(location.pathname), Date.now());
    this.shell_ = new Shell(root, this);
    this.image_ = new ImageFeed(this.shell_.job.picture);
    this.image_.on_range = (range) => this.dispatch({ type: "range", range });
  }

  start(): void {
    window.addEventListener("popstate", () => this.go(parse_route(location.pathname)));
    window.addEventListener("keydown", (event) => this.key(event));
    setInterval(() => this.dispatch({ type: "tick", now_ms: Date.now() }), 1000);
    void this.load_scenes();
    this.enter(this.state_.route);
  }

  private dispatch(action: Action): void {
    this.state_ = reduce(this.state_, action);
    if (this.drawing_) return;
    this.drawing_ = true;
    queueMicrotask(() => {
      this.drawing_ = false;
      this.shell_.update(this.state_);
    });
  }

  /** Runs `body` once what was dispatched before is on the page: the drawing was queued first. */
  private after_draw(body: () => void): void {
    queueMicrotask(body);
  }

  // Places

  navigate(path: string): void {
    const route = parse_route(path);
    if (!same_route(route, this.state_.route)) history.pushState(null, "", route_path(route));
    this.go(route);
  }

  private go(route: Route): void {
    if (same_route(route, this.state_.route)) return;
    this.following_?.stop();
    this.poll_?.stop();
    this.dispatch({ type: "route", route });
    this.enter(route);
    this.after_draw(() => {
      window.scrollTo(0, 0);
      this.shell_.focus_page();
    });
  }

  private enter(route: Route): void {
    this.image_.reset();
    this.following_ = null;
    this.poll_ = null;
    switch (route.page) {
      case "home": this.watch_list(); break;
      case "job": this.follow(route.id); break;
      case "batches": this.watch_batches(); break;
      case "batch": this.watch_batch(route.id); break;
    }
    this.dispatch({ type: "tick", now_ms: Date.now() });
  }

  private watch<Page>(
    ask: PollHandlers<Page>["ask"], take: (page: Page) => void, is_busy: () => boolean,
  ): void {
    this.poll_ = poll<Page>({
      ask, is_busy,
      on_page: (page) => {
        this.line_up();
        take(page);
      },
      on_lost: (problem, retry_at_ms) => this.line_down(problem, retry_at_ms),
      on_refused: (problem) => {
        this.dispatch({ type: "line", line: { state: "ended", retry_at_ms: 0, reason: "" } });
        this.dispatch({ type: "missing", reason: explain(problem) });
      },
    });
  }

  private watch_list(): void {
    this.watch((signal) => api.list_jobs(null, signal),
      (page) => this.dispatch({ type: "jobs", page, older: false, now_ms: Date.now() }),
      () => Object.values(this.state_.jobs).some((job) => !is_final(job.state)));
  }

  private watch_batches(): void {
    this.watch((signal) => api.list_batches(signal),
      (batches) => this.dispatch({ type: "batches", batches }),
      () => this.state_.batches?.some((batch) => batch.state === "running") ?? false);
  }

  private watch_batch(id: string): void {
    this.watch((signal) => api.get_batch(id, signal), (batch) => this.batch_news(batch),
      () => this.state_.batch?.state === "running");
  }

  private batch_news(batch: Batch): void {
    const before = this.state_.batch;
    this.dispatch({ type: "batch", batch });
    if (before && before.state !== batch.state) this.shell_.say(`The batch is ${batch.state}`);
  }

  command_batch(id: string, what: "cancel" | "rerun"): void {
    api.command_batch(id, what).then((batch) => {
      this.batch_news(batch);
      this.poll_?.now();
    }, (error: unknown) => this.command_failed(error));
  }

  private follow(id: string): void {
    const known = this.state_.jobs[id];
    if (known) this.want_image(known);
    this.following_ = follow_job(id, {
      on_job: (job) => this.job_news(job),
      on_live: () => this.line_up(),
      on_lost: (problem, retry_at_ms) => this.line_down(problem, retry_at_ms),
      on_refused: (problem) => {
        this.dispatch({ type: "line", line: { state: "ended", retry_at_ms: 0, reason: "" } });
        this.dispatch({ type: "missing", reason: explain(problem) });
      },
    });
  }

  private line_up(): void {
    if (this.state_.line.state === "live") return;
    const was_lost = this.state_.line.state === "lost";
    this.dispatch({ type: "line", line: { state: "live", retry_at_ms: 0, reason: "" } });
    if (was_lost) void this.load_scenes();
  }

  private line_down(problem: Problem, retry_at_ms: number): void {
    this.dispatch({ type: "line", line: { state: "lost", retry_at_ms, reason: explain(problem) } });
  }

  retry_now(): void {
    this.following_?.retry_now();
    this.poll_?.now();
  }

  // Jobs

  private job_news(job: Job): void {
    const before = this.state_.jobs[job.id];
    this.dispatch({ type: "job", job, now_ms: Date.now() });
    const kept = this.state_.jobs[job.id] ?? job;
    const text = announcement(before, kept);
    if (text) this.shell_.say(text);
    this.want_image(kept);
    this.want_accuracy(kept);
    if (is_final(kept.state)) {
      this.dispatch({ type: "line", line: { state: "ended", retry_at_ms: 0, reason: "" } });
      void this.load_scene(kept.scene); // its tree is known by now
    } else if (!this.state_.scenes[kept.scene] && !this.asked_scenes_.has(kept.scene)) {
      void this.load_scene(kept.scene);
    }
  }

  private want_image(job: Job, urgent = false): void {
    const route = this.state_.route;
    if (route.page !== "job" || route.id !== job.id || !job.image) return;
    this.image_.want({
      job: job.id, revision: job.image.revision, exposure: this.state_.exposure, layer: this.state_.layer,
    }, urgent || is_final(job.state));
  }

  /** The curve of the job on the page: at most every two seconds, and once more at its end. */
  private want_accuracy(job: Job): void {
    const route = this.state_.route;
    if (route.page !== "job" || route.id !== job.id || !job.accuracy) return;
    const now = performance.now();
    if (!is_final(job.state) && now - this.accuracy_asked_ms_ < kAccuracyPaceMs) return;
    this.accuracy_asked_ms_ = now;
    api.get_accuracy(job.id).then(
      (accuracy) => this.dispatch({ type: "accuracy", job: job.id, accuracy }),
      () => undefined); // the next event asks again
  }

  cancel(id: string): void {
    api.cancel_job(id).then((job) => this.job_news(job), (error: unknown) => this.command_failed(error));
  }

  extend(id: string, error: number): void {
    api.extend_job(id, error).then((job) => {
      this.job_news(job);
      this.navigate(route_path({ page: "job", id: job.id }));
    }, (failure: unknown) => this.command_failed(failure));
  }

  private command_failed(error: unknown): void {
    if (!(error instanceof Problem)) throw error;
    this.dispatch({ type: "command_failed", problem: error });
  }

  render_again(id: string): void {
    const job = this.state_.jobs[id];
    if (!job) return;
    const cameras = this.state_.scenes[job.scene]?.cameras ?? [];
    this.dispatch({ type: "form_filled", values: from_job(job, cameras) });
    this.navigate("/");
    this.after_draw(() => this.shell_.form.focus());
  }

  show_older(): void {
    api.list_jobs(this.state_.older_cursor).then(
      (page) => this.dispatch({ type: "jobs", page, older: true, now_ms: Date.now() }),
      (error: unknown) => this.command_failed(error));
  }

  // The form

  set_field(key: FormKey, value: string): void {
    this.dispatch({ type: "form", key, value });
  }

  submit(): void {
    if (this.state_.submitting) return;
    const errors = check_form(this.state_.form);
    if (Object.keys(errors).length > 0) {
      this.dispatch({ type: "form_invalid", errors });
      this.after_draw(() => this.shell_.form.focus_error());
      return;
    }
    this.dispatch({ type: "submit_started" });
    const request = to_request(this.state_.form);
    api.submit_job(request, this.submission_key(JSON.stringify(request))).then(
      (job) => {
        this.submission_ = { body: "", key: "" };
        this.dispatch({ type: "submit_done" });
        this.job_news(job);
        this.navigate(route_path({ page: "job", id: job.id }));
      },
      (error: unknown) => this.submit_failed(error));
  }

  /** One key for all tries of one request: a lost answer never makes a second job. */
  private submission_key(body: string): string {
    if (body !== this.submission_.body) {
      const random = crypto.getRandomValues(new Uint32Array(4));
      this.submission_ = { body, key: Array.from(random, (word) => word.toString(16)).join("-") };
    }
    return this.submission_.key;
  }

  private submit_failed(error: unknown): void {
    if (!(error instanceof Problem)) throw error;
    this.dispatch({ type: "submit_failed", problem: error, errors: place_errors(error.fields) });
    this.after_draw(() => this.shell_.form.focus_error());
  }

  // Scenes

  private async load_scenes(): Promise<void> {
    try {
      this.dispatch({ type: "scenes", scenes: await api.list_scenes() });
    } catch (error) {
      if (!(error instanceof Problem)) throw error; // a lost line is shown by the poll already
    }
  }

  private async load_scene(id: string): Promise<void> {
    this.asked_scenes_.add(id);
    try {
      this.dispatch({ type: "scene", scene: await api.get_scene(id) });
    } catch (error) {
      if (!(error instanceof Problem)) throw error; // deleted scenes keep their jobs
    }
  }

  upload(files: Promise<SceneFile[]>): void {
    files.then((list) => {
      const plans = plan_uploads(list);
      if (plans.length > 0 && this.state_.route.page !== "home") this.navigate("/");
      for (const plan of plans) this.send(plan);
    }, () => this.shell_.say("The dropped files could not be read"));
  }

  private send(plan: UploadPlan): void {
    const id = this.next_upload_++;
    this.dispatch({
      type: "upload_started", id, label: plan.label, files: plan.files.length, total: plan.total_bytes,
    });
    const handle = api.upload_scene(plan, (sent, total) =>
      this.dispatch({ type: "upload_progress", id, sent, total }));
    this.uploading_.set(id, handle);
    handle.done.then((scene) => {
      this.dispatch({ type: "upload_done", id, scene });
      this.shell_.say(`Scene ${plan.label} is ready`);
    }, (error: unknown) => {
      if (!(error instanceof Problem)) throw error;
      this.dispatch({ type: "upload_failed", id, problem: error });
    }).finally(() => this.uploading_.delete(id));
  }

  stop_upload(id: number): void {
    this.uploading_.get(id)?.abort();
  }

  dismiss_upload(id: number): void {
    this.dispatch({ type: "upload_dismissed", id });
  }

  // The picture

  set_exposure(stops: number): void {
    const { min, max } = kExposureRange;
    const value = Math.round(Math.min(max, Math.max(min, stops)) * 10) / 10;
    this.dispatch({ type: "exposure", value });
    clearTimeout(this.exposure_timer_);
    this.exposure_timer_ = window.setTimeout(() => {
      const route = this.state_.route;
      const job = route.page === "job" ? this.state_.jobs[route.id] : undefined;
      if (job) this.want_image(job, true);
    }, kExposureSettleMs);
  }

  set_layer(layer: Layer): void {
    this.dispatch({ type: "layer", value: layer });
    const route = this.state_.route;
    const job = route.page === "job" ? this.state_.jobs[route.id] : undefined;
    if (job) this.want_image(job, true);
  }

  set_zoom(zoom: "fit" | "actual"): void {
    this.dispatch({ type: "zoom", value: zoom });
  }

  // Keys

  private key(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const typing = target.closest("textarea, select, [contenteditable], dialog, input:not([type=range])") !== null;
    const what = shortcut(event, this.state_.route.page === "job", typing);
    if (!what) return;
    event.preventDefault();
    this.run(what);
  }

  private run(what: Shortcut): void {
    switch (what) {
      case "help": return this.shell_.help.open();
      case "home": return this.navigate("/");
      case "batches": return this.navigate("/batches");
      case "upload": return this.shell_.uploads.choose();
      case "form": {
        this.navigate("/");
        this.after_draw(() => this.shell_.form.focus());
        return;
      }
      case "darker": return this.set_exposure(this.state_.exposure - 0.5);
      case "brighter": return this.set_exposure(this.state_.exposure + 0.5);
      case "reset": return this.set_exposure(0);
      case "fit": return this.set_zoom("fit");
      case "actual": return this.set_zoom("actual");
      case "cancel": case "again": case "png": case "exr": return this.shell_.job.press(what);
    }
  }
}
