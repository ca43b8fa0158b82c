// The wire types of proto/openapi.yaml that the page uses. Hand-written: the
// page reads a part of each answer and must survive fields it does not know.

export type JobState =
  | "queued" | "preparing" | "rendering" | "cancelling"
  | "completed" | "failed" | "cancelled";

export type Vec3 = [number, number, number];

export interface OwnCamera {
  eye: Vec3;
  look_at: Vec3;
  up?: Vec3;
  fov_deg?: number;
  /** Metres from edge to edge; in place of the angle of an orthographic camera. */
  view_height?: number;
}

export interface JobRequest {
  scene: string;
  name?: string;
  camera?: number | string | OwnCamera;
  width: number;
  height: number;
  stop: { samples?: number; seconds?: number; error?: number; tile_samples?: number[] };
  light_model?: string;
  light_model_overrides?: Record<string, string | boolean>;
  max_depth?: number;
  branches?: number;
  seed?: number;
  pixel_mode?: string;
  direction_sampling?: string;
  emitter_sampling?: boolean;
  emitter_choice?: string;
  texture_filter?: string;
  filter?: string;
  sampler?: string;
  adaptive?: boolean;
  effects?: EffectChoice;
  /** Made beside the picture. */
  layers?: string[];
  lens?: { radius: number; focus_distance?: number };
  crop?: { x: number; y: number; full_width: number; full_height: number };
  /** What the scene's tree may take. */
  tree?: { references_per_triangle?: number; max_bytes?: number };
  tile?: number;
  priority?: number;
}

/** What of the scene's effects is simulated. */
export type EffectChoice = string | { without: string[] };

export interface EffectLine {
  effect: string;
  called_for: boolean;
  simulated: boolean;
  /** The material, light or setting that decides. */
  evidence: string;
  /** Of leaving it out; empty where it is simulated. */
  grade: string;
  left_out: string;
}

export interface EffectReport {
  label: string;
  /** Something that the scene calls for is left out. */
  approximation: boolean;
  list: EffectLine[];
}

/** RFC 9457 document, as in an answer or in a failed job. */
export interface ProblemView {
  title: string;
  status: number;
  detail: string;
  code: string;
  where?: string;
}

export interface Warning {
  code: string;
  message: string;
  /** File and line or JSON pointer; empty when it has no place. */
  where: string;
  /** How often it occurred; one when absent. */
  count?: number;
}

/** A value with its 95 % interval. */
export interface Figure {
  value: number;
  low: number;
  high: number;
}

/** How far a picture is from its limit; noise alone. */
export interface Accuracy {
  grade: "unknown" | "rough" | "measured";
  error: Figure | null;
  heavy_tailed: boolean;
  remarks: string[];
  least_samples: number;
  target: number | null;
  target_reached: boolean | null;
}

export interface SecondsRange {
  value: number;
  low: number;
  high: number;
}

/** Error against time, and what is expected of it. */
export interface JobAccuracy {
  points: { render_seconds: number; samples: number; error: Figure | null }[];
  slope: { value: number; standard_error: number } | null;
  seconds_to_halve_error: SecondsRange | null;
  target: number | null;
  seconds_to_target: SecondsRange | null;
  prices: { error: number; reached: boolean; seconds: SecondsRange | null; seconds_left: SecondsRange | null }[];
  forecasts: { hit: boolean | null }[];
  tile_samples: number[] | null;
}

/** What the stage can show of every job: the picture or one of its maps. */
export const kLayers = ["beauty", "error", "samples", "seconds"] as const;
/** Only of jobs that ask for them. */
export const kAskedLayers = [
  "albedo", "normal", "depth", "object_id", "material_id", "emission", "direct", "indirect",
] as const;
export type AskedLayer = (typeof kAskedLayers)[number];
export type Layer = (typeof kLayers)[number] | AskedLayer;

/** What there is to show of a job. */
export const layers_of = (request: JobRequest): Layer[] =>
  [...kLayers, ...kAskedLayers.filter((layer) => request.layers?.includes(layer))];

/** What the colours of a map stand for. */
export interface MapRange {
  low: number;
  high: number;
  scale: string;
}

export interface Job {
  id: string;
  scene: string;
  name: string;
  state: JobState;
  revision: number;
  created_at: string;
  started_at: string | null;
  finished_at: string | null;
  request: JobRequest;
  queue_position: number | null;
  prepare: { stage: string; fraction: number } | null;
  progress: {
    fraction: number;
    samples_done: number;
    samples_target: number;
    tiles_done: number;
    tiles_total: number;
  };
  elapsed_seconds: number;
  remaining_seconds: number | null;
  statistics: Record<string, unknown>;
  /** Absent from servers that do not judge errors. */
  accuracy?: Accuracy | null;
  done_by?: "samples" | "seconds" | "error" | null;
  /** The completed job whose samples this one has taken over. */
  continues?: { job: string; samples: number } | null;
  /** Null until the scene is read. */
  effects?: EffectReport | null;
  warnings: Warning[];
  error: ProblemView | null;
  image: { revision: number; png: string; exr: string } | null;
}

export interface Scene {
  id: string;
  name: string;
  kind: string;
  bytes: number;
  created_at: string;
  root_file?: string;
  triangles: number;
  /** Of zero area. */
  dropped_triangles?: number;
  materials: number;
  lights: {
    point: number;
    spot?: number;
    directional?: number;
    environment?: boolean;
    emitting_triangles: number;
  };
  cameras: { index: number; name: string }[];
  /** Of a job with the default settings. */
  effects?: EffectReport | null;
  warnings: Warning[];
  tree: Record<string, number> | null;
  cache: "absent" | "building" | "ready";
}

export interface JobPage {
  jobs: Job[];
  next_cursor: string | null;
}

export type ItemState = "waiting" | "active" | "completed" | "failed" | "cancelled" | "skipped";

/** Many pictures together, as the list has them. */
export interface BatchSummary {
  id: string;
  name: string;
  state: "running" | "completed" | "failed" | "cancelled";
  revision: number;
  created_at: string;
  finished_at: string | null;
  counts: Record<ItemState | "reused" | "total", number>;
}

export interface BatchItem {
  name: string;
  state: ItemState;
  job: string | null;
  reused: boolean;
  error: ProblemView | null;
}

export interface Batch extends BatchSummary {
  items: BatchItem[];
}

const kFinal: readonly JobState[] = ["completed", "failed", "cancelled"];

export const is_final = (state: JobState): boolean => kFinal.includes(state);

const is_object = (value: unknown): value is Record<string, unknown> =>
  typeof value === "object" && value !== null;

export function is_job(value: unknown): value is Job {
  return is_object(value) && typeof value["id"] === "string" &&
    typeof value["state"] === "string" && typeof value["revision"] === "number" &&
    is_object(value["progress"]) && is_object(value["request"]);
}

export const is_scene = (value: unknown): value is Scene =>
  is_object(value) && typeof value["id"] === "string";

export const is_batch_summary = (value: unknown): value is BatchSummary =>
  is_object(value) && typeof value["id"] === "string" && is_object(value["counts"]);

export const is_batch = (value: unknown): value is Batch =>
  is_batch_summary(value) && Array.isArray((value as unknown as Record<string, unknown>)["items"]);

export const batch_title = (batch: BatchSummary): string => batch.name || `Batch ${batch.id.slice(0, 10)}`;

/** What to call a job: its own name, its scene's, or the start of its id. */
export function job_title(job: Job, scene: Scene | undefined): string {
  return job.name || scene?.name || `Job ${job.id.slice(0, 10)}`;
}

export const scene_title = (scene: Scene): string =>
  scene.name || `Scene ${scene.id.slice(0, 8)}`;
