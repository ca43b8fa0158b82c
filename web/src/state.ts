// The page's whole state as one plain value and the pure function that moves
// it. The view is a function of this value; nothing else is remembered.

import {
  is_final, type Batch, type BatchSummary, type Job, type JobAccuracy, type JobPage, type Layer, type MapRange, type Scene,
} from "./contract";
import { kDefaultForm, type FormErrors, type FormKey, type FormValues } from "./form";
import { explain, type FieldProblem, type Problem } from "./problem";
import type { Route } from "./route";

export interface Upload {
  id: number;
  label: string;
  files: number;
  sent: number;
  total: number;
  phase: "sending" | "importing" | "done" | "failed";
  problem: Problem | null;
  scene: string | null;
}

export interface Line {
  state: "connecting" | "live" | "lost" | "ended";
  retry_at_ms: number;
  reason: string;
}

export interface State {
  route: Route;
  now_ms: number;
  line: Line;
  jobs: Record<string, Job>;
  /** When each job was last heard of, for clocks that run between events. */
  heard_ms: Record<string, number>;
  jobs_loaded: boolean;
  /** Where the list of older jobs goes on; null at its end. */
  older_cursor: string | null;
  /** Newest first; null before the first answer. */
  batches: BatchSummary[] | null;
  /** The batch on the page, once it is known. */
  batch: Batch | null;
  scenes: Record<string, Scene>;
  scenes_loaded: boolean;
  uploads: Upload[];
  form: FormValues;
  form_errors: FormErrors;
  form_problem: string;
  submitting: boolean;
  /** A page for a job or a batch that the server does not know. */
  missing: string;
  /** Outcome of the last command on the job page (cancel), when it failed. */
  command_problem: string;
  exposure: number;
  zoom: "fit" | "actual";
  layer: Layer;
  /** What the colours on the stage stand for; null for the picture itself. */
  range: MapRange | null;
  /** Of the job on the page. */
  accuracy: JobAccuracy | null;
}

export type Action =
  | { type: "route"; route: Route }
  | { type: "tick"; now_ms: number }
  | { type: "line"; line: Line }
  | { type: "jobs"; page: JobPage; older: boolean; now_ms: number }
  | { type: "job"; job: Job; now_ms: number }
  | { type: "batches"; batches: BatchSummary[] }
  | { type: "batch"; batch: Batch }
  | { type: "missing"; reason: string }
  | { type: "command_failed"; problem: Problem }
  | { type: "scenes"; scenes: Scene[] }
  | { type: "scene"; scene: Scene }
  | { type: "upload_started"; id: number; label: string; files: number; total: number }
  | { type: "upload_progress"; id: number; sent: number; total: number }
  | { type: "upload_done"; id: number; scene: Scene }
  | { type: "upload_failed"; id: number; problem: Problem }
  | { type: "upload_dismissed"; id: number }
  | { type: "form"; key: FormKey; value: string }
  | { type: "form_filled"; values: FormValues }
  | { type: "submit_started" }
  | { type: "submit_done" }
  | { type: "form_invalid"; errors: FormErrors }
  | { type: "submit_failed"; problem: Problem; errors: FormErrors }
  | { type: "exposure"; value: number }
  | { type: "zoom"; value: "fit" | "actual" }
  | { type: "layer"; value: Layer }
  | { type: "range"; range: MapRange | null }
  | { type: "accuracy"; job: string; accuracy: JobAccuracy };

export function initial_state(route: Route, now_ms: number): State {
  return {
    route, now_ms,
    line: { state: "connecting", retry_at_ms: 0, reason: "" },
    jobs: {}, heard_ms: {}, jobs_loaded: false, older_cursor: null,
    batches: null, batch: null,
    scenes: {}, scenes_loaded: false,
    uploads: [],
    form: kDefaultForm, form_errors: {}, form_problem: "", submitting: false,
    missing: "", command_problem: "",
    exposure: 0, zoom: "fit", layer: "beauty", range: null, accuracy: null,
  };
}

/** A job's news replaces the old unless it is older, or would leave a final state. */
export function newer_job(known: Job | undefined, news: Job): Job {
  if (!known || news.revision > known.revision) {
    return known && is_final(known.state) && !is_final(news.state) ? known : news;
  }
  if (news.revision === known.revision) return is_final(known.state) ? known : news;
  return known;
}

function with_job(state: State, job: Job, now_ms: number): State {
  const kept = newer_job(state.jobs[job.id], job);
  if (kept !== job) return state;
  return {
    ...state,
    jobs: { ...state.jobs, [job.id]: job },
    heard_ms: { ...state.heard_ms, [job.id]: now_ms },
  };
}

/** `older` marks a page fetched below the first; only such a page, or the first one ever, moves the cursor. */
function with_jobs(state: State, page: JobPage, older: boolean, now_ms: number): State {
  const moved = page.jobs.reduce((last, job) => with_job(last, job, now_ms), state);
  const cursor = older || !state.jobs_loaded ? page.next_cursor : state.older_cursor;
  return { ...moved, jobs_loaded: true, older_cursor: cursor };
}

function with_upload(state: State, id: number, change: Partial<Upload>): State {
  return {
    ...state,
    uploads: state.uploads.map((upload) => (upload.id === id ? { ...upload, ...change } : upload)),
  };
}

function without(errors: FormErrors, key: FormKey): FormErrors {
  const copy = { ...errors };
  delete copy[key];
  return copy;
}

function with_scene(state: State, scene: Scene): State {
  return { ...state, scenes: { ...state.scenes, [scene.id]: scene } };
}

function chosen(state: State, scene: string): State {
  return {
    ...state,
    form: { ...state.form, scene, camera: "0" },
    form_errors: without(without(state.form_errors, "scene"), "camera"),
  };
}

const on_page = (state: State, job: string): boolean =>
  state.route.page === "job" && state.route.id === job;

/** News of another batch than the one on the page, or older news, change nothing. */
function with_batch(state: State, batch: Batch): State {
  const wanted = state.route.page === "batch" && state.route.id === batch.id;
  if (!wanted || (state.batch !== null && state.batch.revision > batch.revision)) return state;
  return { ...state, batch, command_problem: "" };
}

export function reduce(state: State, action: Action): State {
  switch (action.type) {
    case "route":
      return {
        ...state, route: action.route, missing: "", command_problem: "", exposure: 0, zoom: "fit",
        layer: "beauty", range: null, accuracy: null, batch: null,
        line: { state: "connecting", retry_at_ms: 0, reason: "" },
      };
    case "tick":
      return { ...state, now_ms: action.now_ms };
    case "line":
      return { ...state, line: action.line };
    case "jobs":
      return with_jobs(state, action.page, action.older, action.now_ms);
    case "job":
      return with_job({ ...state, missing: "" }, action.job, action.now_ms);
    case "batches":
      return { ...state, batches: action.batches };
    case "batch":
      return with_batch(state, action.batch);
    case "missing":
      return { ...state, missing: action.reason };
    case "command_failed":
      return { ...state, command_problem: explain(action.problem) };
    case "scenes":
      return with_scenes(state, action.scenes);
    case "scene":
      return with_scene(state, action.scene);
    case "form":
      return with_field(state, action.key, action.value);
    case "form_filled":
      return { ...state, form: action.values, form_errors: {}, form_problem: "" };
    case "submit_started":
      return { ...state, submitting: true, form_errors: {}, form_problem: "" };
    case "submit_done":
      return { ...state, submitting: false };
    case "form_invalid":
      return { ...state, form_errors: action.errors, form_problem: "" };
    case "submit_failed":
      return {
        ...state, submitting: false, form_errors: action.errors,
        form_problem: unplaced(action.problem, action.errors),
      };
    case "exposure":
      return { ...state, exposure: action.value };
    case "zoom":
      return { ...state, zoom: action.value };
    case "layer":
      return { ...state, layer: action.value };
    case "range":
      return { ...state, range: action.range };
    case "accuracy":
      return on_page(state, action.job) ? { ...state, accuracy: action.accuracy } : state;
    default:
      return reduce_upload(state, action);
  }
}

type UploadAction = Extract<Action, { type: `upload_${string}` }>;

function reduce_upload(state: State, action: UploadAction): State {
  switch (action.type) {
    case "upload_started": {
      const upload: Upload = {
        id: action.id, label: action.label, files: action.files, sent: 0, total: action.total,
        phase: "sending", problem: null, scene: null,
      };
      return { ...state, uploads: [upload, ...state.uploads].slice(0, 8) };
    }
    case "upload_progress": {
      const phase = action.total > 0 && action.sent >= action.total ? "importing" : "sending";
      return with_upload(state, action.id, { sent: action.sent, total: action.total, phase });
    }
    case "upload_done":
      return chosen(
        with_scene(
          with_upload(state, action.id, { phase: "done", scene: action.scene.id }), action.scene),
        action.scene.id);
    case "upload_failed":
      return with_upload(state, action.id, { phase: "failed", problem: action.problem });
    case "upload_dismissed":
      return { ...state, uploads: state.uploads.filter((upload) => upload.id !== action.id) };
  }
}

function with_scenes(state: State, scenes: Scene[]): State {
  const next: Record<string, Scene> = { ...state.scenes };
  for (const scene of scenes) next[scene.id] = scene;
  const moved = { ...state, scenes: next, scenes_loaded: true };
  const first = scenes[0];
  return state.form.scene === "" && first ? chosen(moved, first.id) : moved;
}

function with_field(state: State, key: FormKey, value: string): State {
  if (key === "scene") return chosen(state, value);
  const form = { ...state.form, [key]: value };
  // Who names a target does not mean it to be cut off by a number that nobody has typed.
  const target = key === "error" || key === "seconds";
  if (target && value !== "" && form.samples === kDefaultForm.samples) form.samples = "";
  return {
    ...state,
    form,
    form_errors: without(state.form_errors, key),
  };
}

/** What of a problem is not already shown at a field. */
function unplaced(problem: Problem, errors: FormErrors): string {
  const placed = Object.keys(errors).length;
  if (placed > 0 && placed >= problem.fields.length) return "";
  const rest = problem.fields
    .filter((field: FieldProblem) => !Object.values(errors).includes(field.message))
    .map((field) => `${field.pointer} ${field.message}`);
  return [explain(problem), ...rest].join(" ");
}

/** Jobs for the list: newest first. */
export function jobs_in_order(state: State): Job[] {
  return Object.values(state.jobs).sort((a, b) =>
    b.created_at.localeCompare(a.created_at) || b.id.localeCompare(a.id));
}

/** Seconds to add to the server's clocks for the time since its last word. */
export function since_heard(state: State, job: Job): number {
  if (is_final(job.state) || state.line.state === "lost" || !job.started_at) return 0;
  return Math.max(0, (state.now_ms - (state.heard_ms[job.id] ?? state.now_ms)) / 1000);
}
