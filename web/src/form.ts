// The job form: its fields, their defaults, and the way between the typed text
// and a job request. Errors are placed at fields by their JSON pointer.

import { kAskedLayers, type EffectChoice, type Job, type JobRequest, type OwnCamera, type Vec3 } from "./contract";
import type { FieldProblem } from "./problem";

export type FormKey =
  | "scene" | "camera" | "eye" | "look_at" | "up" | "fov_deg" | "view_height" | "lens" | "crop" | "layers"
  | "width" | "height" | "samples" | "error" | "seconds" | "max_depth"
  | "name" | "seed" | "priority" | "tile" | "branches"
  | "light_model" | "pixel_mode" | "direction_sampling" | "emitter_sampling" | "emitter_choice" | "texture_filter" | "filter" | "sampler" | "adaptive"
  | "effects" | "without" | "tree_references" | "tree_bytes" | OverrideKey;

/** Switches against the named light model; empty: as the model has it. */
const kOverrides = ["phong", "fresnel", "radiance_scaling", "diffuse_sampling", "roulette"] as const;
type OverrideKey = (typeof kOverrides)[number];

export type FormValues = Record<FormKey, string>;
export type FormErrors = Partial<Record<FormKey, string>>;

/** Value of the effects field that shows the list of what to leave out. */
export const kWithout = "without";

/** Value of the camera field that shows the fields of an own camera. */
export const kOwnCamera = "own";

const kMostSamples = 1048576;
/** Of a tree, by the server; a job always tells. */
const kUsualReferences = 4;

export const kDefaultForm: FormValues = {
  scene: "", camera: "0", eye: "0 0 5", look_at: "0 0 0", up: "0 1 0", fov_deg: "40", view_height: "",
  lens: "", crop: "", layers: "",
  width: "640", height: "480", samples: "64", error: "", seconds: "", max_depth: "",
  name: "", seed: "0", priority: "10", tile: "64", branches: "1",
  light_model: "physical", pixel_mode: "random", direction_sampling: "bsdf", emitter_sampling: "true", emitter_choice: "auto", texture_filter: "exact", filter: "box", sampler: "random", adaptive: "false",
  effects: "auto", without: "", tree_references: "", tree_bytes: "",
  phong: "", fresnel: "", radiance_scaling: "", diffuse_sampling: "", roulette: "",
};

type Kind = "scene" | "camera" | "integer" | "number" | "vector" | "text" | "choice" | "effects" | "layers";

export interface FieldSpec {
  key: FormKey;
  pointer: string;
  label: string;
  hint: string;
  kind: Kind;
  /** Where the field stands: always, with an own camera, or under the details. */
  group: "main" | "camera" | "more";
  min?: number;
  max?: number;
  /** May be left empty: the server then chooses. */
  optional?: boolean;
  /** Numbers of a vector, if not 3, as an example. */
  example?: string;
  choices?: readonly (readonly [value: string, label: string])[];
}

const kAsModel = ["", "As the light model"] as const;
const kSwitch = [kAsModel, ["true", "On"], ["false", "Off"]] as const;

export const kFields: readonly FieldSpec[] = [
  { key: "scene", pointer: "/scene", label: "Scene", hint: "", kind: "scene", group: "main" },
  { key: "camera", pointer: "/camera", label: "Camera", hint: "", kind: "camera", group: "main" },
  { key: "eye", pointer: "/camera/eye", label: "Eye", hint: "x y z, metres", kind: "vector", group: "camera" },
  { key: "look_at", pointer: "/camera/look_at", label: "Look at", hint: "x y z, metres", kind: "vector", group: "camera" },
  { key: "up", pointer: "/camera/up", label: "Up", hint: "x y z", kind: "vector", group: "camera" },
  { key: "fov_deg", pointer: "/camera/fov_deg", label: "Field of view", hint: "degrees", kind: "number", group: "camera" },
  { key: "view_height", pointer: "/camera/view_height", label: "View height", hint: "metres; makes it orthographic", kind: "number", group: "camera", min: 1e-9, max: 1e15, optional: true },
  { key: "width", pointer: "/width", label: "Width", hint: "pixels", kind: "integer", group: "main", min: 1, max: 16384 },
  { key: "height", pointer: "/height", label: "Height", hint: "pixels", kind: "integer", group: "main", min: 1, max: 16384 },
  { key: "samples", pointer: "/stop/samples", label: "Samples", hint: "per pixel, at most", kind: "integer", group: "main", min: 1, max: kMostSamples, optional: true },
  { key: "error", pointer: "/stop/error", label: "Error target", hint: "%; stops when reached", kind: "number", group: "main", min: 0.01, max: 100, optional: true },
  { key: "seconds", pointer: "/stop/seconds", label: "Time limit", hint: "seconds of rendering", kind: "number", group: "main", min: 0.001, max: 604800, optional: true },
  { key: "max_depth", pointer: "/max_depth", label: "Max depth", hint: "reflections; empty: by the light model", kind: "integer", group: "main", min: 0, max: 1024, optional: true },
  { key: "light_model", pointer: "/light_model", label: "Light model", hint: "", kind: "choice", group: "main",
    choices: [["physical", "Physical"], ["seed", "Seed (as first written)"]] },
  { key: "lens", pointer: "/lens", label: "Lens", hint: "radius and focus distance, metres", kind: "vector", group: "more", optional: true, example: "0.05 2" },
  { key: "crop", pointer: "/crop", label: "Window of", hint: "left and top, width and height of the whole picture", kind: "vector", group: "more", optional: true, example: "640 0 1920 1080" },
  { key: "layers", pointer: "/layers", label: "Layers", hint: "", kind: "layers", group: "more" },
  { key: "name", pointer: "/name", label: "Name", hint: "for the list; optional", kind: "text", group: "more" },
  { key: "seed", pointer: "/seed", label: "Seed", hint: "of the noise", kind: "integer", group: "more", min: 0 },
  { key: "priority", pointer: "/priority", label: "Priority", hint: "1 to 100", kind: "integer", group: "more", min: 1, max: 100 },
  { key: "tile", pointer: "/tile", label: "Tile edge", hint: "pixels", kind: "integer", group: "more", min: 1, max: 4096 },
  { key: "tree_references", pointer: "/tree/references_per_triangle", label: "Tree references", hint: "a triangle, at most; empty: 4", kind: "number", group: "more", min: 1, max: 64, optional: true },
  { key: "tree_bytes", pointer: "/tree/max_bytes", label: "Tree memory", hint: "bytes, at most; empty: any", kind: "integer", group: "more", min: 1, optional: true },
  { key: "branches", pointer: "/branches", label: "Branches", hint: "rays a hit", kind: "integer", group: "more", min: 1, max: 16 },
  { key: "pixel_mode", pointer: "/pixel_mode", label: "Sample position", hint: "", kind: "choice", group: "more",
    choices: [["random", "Random in the pixel"], ["centre", "Pixel centre"]] },
  { key: "direction_sampling", pointer: "/direction_sampling", label: "Directions", hint: "", kind: "choice", group: "more",
    choices: [["bsdf", "By the material"], ["uniform_sphere", "Uniform (reference)"]] },
  { key: "emitter_sampling", pointer: "/emitter_sampling", label: "Emitter sampling", hint: "", kind: "choice", group: "more",
    choices: [["true", "On"], ["false", "Off"]] },
  { key: "emitter_choice", pointer: "/emitter_choice", label: "Emitters chosen", hint: "", kind: "choice", group: "more",
    choices: [["auto", "By their number"], ["power", "By power"], ["tree", "From a tree"]] },
  { key: "texture_filter", pointer: "/texture_filter", label: "Textures read", hint: "", kind: "choice", group: "more",
    choices: [["exact", "At the point"], ["footprint", "Over the pixel (less noise, biased)"]] },
  { key: "filter", pointer: "/filter", label: "Pixel filter", hint: "", kind: "choice", group: "more",
    choices: [["box", "Box"], ["blackman_harris", "Blackman-Harris (softer)"]] },
  { key: "sampler", pointer: "/sampler", label: "Sampler", hint: "", kind: "choice", group: "more",
    choices: [["random", "Random numbers"], ["sobol", "Sobol points (less noise)"]] },
  { key: "adaptive", pointer: "/adaptive", label: "Samples go", hint: "", kind: "choice", group: "more",
    choices: [["false", "Everywhere alike"], ["true", "Where the error is (needs error or seconds)"]] },
  { key: "effects", pointer: "/effects", label: "Effects", hint: "", kind: "choice", group: "more",
    choices: [["auto", "What the scene calls for"], ["all", "All (same picture, more work)"], [kWithout, "Leave some out (approximation)…"]] },
  { key: "without", pointer: "/effects/without", label: "Leave out", hint: "", kind: "effects", group: "more" },
  { key: "phong", pointer: "/light_model_overrides/phong", label: "Phong lobe over", hint: "", kind: "choice", group: "more",
    choices: [kAsModel, ["max", "The larger cosine"], ["over_cos_o", "The viewer's cosine"]] },
  { key: "fresnel", pointer: "/light_model_overrides/fresnel", label: "Fresnel", hint: "", kind: "choice", group: "more",
    choices: [kAsModel, ["exact", "Exact"], ["schlick", "Schlick"]] },
  { key: "radiance_scaling", pointer: "/light_model_overrides/radiance_scaling", label: "Radiance scaling", hint: "by n² in glass", kind: "choice", group: "more",
    choices: kSwitch },
  { key: "diffuse_sampling", pointer: "/light_model_overrides/diffuse_sampling", label: "Diffuse sampling", hint: "", kind: "choice", group: "more",
    choices: [kAsModel, ["cosine", "Cosine"], ["uniform", "Uniform"]] },
  { key: "roulette", pointer: "/light_model_overrides/roulette", label: "Russian roulette", hint: "", kind: "choice", group: "more",
    choices: kSwitch },
];

function parse_numbers(text: string, how_many: number): number[] | null {
  const parts = text.trim().split(/[\s,;]+/).map(Number);
  return parts.length === how_many && parts.every(Number.isFinite) ? parts : null;
}

const parse_vector = (text: string): Vec3 | null => parse_numbers(text, 3) as Vec3 | null;

const kCounts: Record<number, string> = { 2: "two", 3: "three", 4: "four" };
function vector_fault(example: string, text: string): string {
  const how_many = example.split(" ").length;
  return parse_numbers(text, how_many) ? "" : `Enter ${kCounts[how_many]} numbers, for example ${example}.`;
}

/** The reason why `text` cannot be sent as this field's value; empty when it can. */
function fault(spec: FieldSpec, text: string): string {
  if (spec.optional && text.trim() === "") return "";
  if (spec.kind === "vector") {
    return vector_fault(spec.example ?? "0 1 4", text);
  }
  if (spec.kind === "number") {
    if (text.trim() === "" || !Number.isFinite(Number(text))) return "Enter a number.";
    return range_fault(spec, text);
  }
  if (spec.kind !== "integer") return "";
  if (!/^-?\d+$/.test(text.trim()) || !Number.isSafeInteger(Number(text))) {
    return "Enter a whole number.";
  }
  return range_fault(spec, text);
}

function range_fault(spec: FieldSpec, text: string): string {
  if (spec.min !== undefined && Number(text) < spec.min) return `Enter ${spec.min} or more.`;
  if (spec.max !== undefined && Number(text) > spec.max) return `Enter ${spec.max} or less.`;
  return "";
}

/** Checks what the page can know; the server checks everything again. */
export function check_form(values: FormValues): FormErrors {
  const errors: FormErrors = {};
  if (!values.scene) errors.scene = "Choose a scene, or upload one first.";
  for (const spec of kFields) {
    if (spec.group === "camera" && values.camera !== kOwnCamera) continue;
    const reason = fault(spec, values[spec.key]);
    if (reason) errors[spec.key] = reason;
  }
  if (values.effects === kWithout && names(values.without).length === 0) errors.without = "Choose at least one effect.";
  if (!["samples", "error", "seconds"].some((key) => values[key as FormKey].trim() !== "")) {
    errors.samples = "Say when to stop: samples, an error target or a time limit.";
  }
  return errors;
}

/** What ends the picture; errors are typed in percent. */
function stop_of(values: FormValues): JobRequest["stop"] {
  const typed = (key: FormKey, per = 1): number | undefined =>
    values[key].trim() === "" ? undefined : Number(values[key]) / per;
  const all = { samples: typed("samples"), error: typed("error", 100), seconds: typed("seconds") };
  return Object.fromEntries(Object.entries(all).filter(([, value]) => value !== undefined));
}

/** The request that checked `values` ask for. */
export function to_request(values: FormValues): JobRequest {
  const number = (key: FormKey): number => Number(values[key].trim());
  return {
    scene: values.scene,
    name: values.name.trim(),
    camera: values.camera === kOwnCamera ? own_camera(values) : number("camera"),
    width: number("width"),
    height: number("height"),
    stop: stop_of(values),
    light_model: values.light_model,
    light_model_overrides: overrides(values),
    ...(values.max_depth.trim() === "" ? {} : { max_depth: number("max_depth") }),
    branches: number("branches"),
    seed: number("seed"),
    pixel_mode: values.pixel_mode,
    direction_sampling: values.direction_sampling,
    emitter_sampling: values.emitter_sampling === "true",
    emitter_choice: values.emitter_choice,
    texture_filter: values.texture_filter,
    filter: values.filter,
    sampler: values.sampler,
    ...(values.adaptive === "true" ? { adaptive: true } : {}),
    effects: values.effects === kWithout ? { without: names(values.without) } : values.effects,
    ...lens_and_crop(values),
    ...tree_budget(values),
    ...(values.layers === "" ? {} : { layers: kAskedLayers.filter((layer) => is_chosen(values.layers, layer)) }),
    tile: number("tile"),
    priority: number("priority"),
  };
}

function lens_and_crop(values: FormValues): Pick<JobRequest, "lens" | "crop"> {
  const [radius, focus_distance] = parse_numbers(values.lens, 2) ?? [];
  const [x, y, full_width, full_height] = parse_numbers(values.crop, 4) ?? [];
  const crop = x !== undefined && y !== undefined && full_width !== undefined && full_height !== undefined;
  return {
    ...(radius !== undefined && focus_distance !== undefined ? { lens: { radius, focus_distance } } : {}),
    ...(crop ? { crop: { x, y, full_width, full_height } } : {}),
  };
}

function tree_budget(values: FormValues): Pick<JobRequest, "tree"> {
  const references = values.tree_references.trim();
  const bytes = values.tree_bytes.trim();
  if (references === "" && bytes === "") return {};
  return { tree: {
    ...(references === "" ? {} : { references_per_triangle: Number(references) }),
    ...(bytes === "" ? {} : { max_bytes: Number(bytes) }),
  } };
}

const names = (text: string): string[] => text.split(",").filter((name) => name !== "");

/** The list `text` with or without `name`; the order is that of the choosing. */
export function toggled(text: string, name: string, on: boolean): string {
  return [...names(text).filter((other) => other !== name), ...(on ? [name] : [])].join(",");
}

export const is_chosen = (text: string, name: string): boolean => names(text).includes(name);

/** As the settings of a job show it. */
export const effects_text = (choice: EffectChoice): string =>
  typeof choice === "string" ? choice : `without ${choice.without.join(", ")}`;

function overrides(values: FormValues): Record<string, string | boolean> {
  const chosen = kOverrides.filter((key) => values[key] !== "");
  return Object.fromEntries(chosen.map((key) => {
    const value = values[key];
    return [key, value === "true" || (value === "false" ? false : value)];
  }));
}

function own_camera(values: FormValues): OwnCamera {
  const vector = (key: FormKey): Vec3 => parse_vector(values[key]) ?? [0, 0, 0];
  return {
    eye: vector("eye"), look_at: vector("look_at"), up: vector("up"),
    ...(values.view_height.trim() === "" ? { fov_deg: Number(values.fov_deg) } : { view_height: Number(values.view_height) }),
  };
}

/** The form that would ask for `job` again; `cameras` are those of its scene. */
export function from_job(job: Job, cameras: readonly { index: number; name: string }[]): FormValues {
  const request = job.request;
  const values = { ...kDefaultForm, scene: request.scene, name: request.name ?? job.name };
  const plain: FormKey[] = [
    "width", "height", "max_depth", "branches", "seed", "tile", "priority",
    "light_model", "pixel_mode", "direction_sampling", "emitter_sampling", "emitter_choice", "texture_filter", "filter", "sampler", "adaptive",
  ];
  const bag = request as unknown as Record<string, unknown>;
  for (const key of plain) if (bag[key] !== undefined) values[key] = String(bag[key]);
  for (const key of kOverrides) {
    const value = request.light_model_overrides?.[key];
    if (value !== undefined) values[key] = String(value);
  }
  const { samples, error, seconds } = request.stop;
  // A job that stops otherwise carries the largest number of samples there may be.
  const other = error !== undefined || seconds !== undefined;
  values.samples = samples === undefined || (other && samples === kMostSamples) ? "" : String(samples);
  values.error = error === undefined ? "" : String(Number((100 * error).toPrecision(12)));
  values.seconds = seconds === undefined ? "" : String(seconds);
  const effects = request.effects ?? "auto";
  values.effects = typeof effects === "string" ? effects : kWithout;
  values.without = typeof effects === "string" ? "" : effects.without.join(",");
  values.layers = kAskedLayers.filter((layer) => request.layers?.includes(layer)).join(",");
  const { references_per_triangle, max_bytes } = request.tree ?? {};
  values.tree_references = references_per_triangle === undefined || references_per_triangle === kUsualReferences ? "" : String(references_per_triangle);
  values.tree_bytes = max_bytes === undefined ? "" : String(max_bytes);
  const { lens, crop } = request;
  if (lens) values.lens = `${lens.radius} ${lens.focus_distance ?? 1}`;
  if (crop) values.crop = `${crop.x} ${crop.y} ${crop.full_width} ${crop.full_height}`;
  const camera = request.camera;
  if (typeof camera === "number") values.camera = String(camera);
  if (typeof camera === "string") {
    values.camera = String(cameras.find((one) => one.name === camera)?.index ?? 0);
  }
  if (typeof camera === "object") Object.assign(values, from_own_camera(camera));
  return values;
}

function from_own_camera(camera: OwnCamera): Partial<FormValues> {
  return {
    camera: kOwnCamera,
    eye: camera.eye.join(" "),
    look_at: camera.look_at.join(" "),
    up: (camera.up ?? [0, 1, 0]).join(" "),
    fov_deg: String(camera.fov_deg ?? 40),
    view_height: camera.view_height === undefined ? "" : String(camera.view_height),
  };
}

/** Puts each problem at the field whose pointer it names or lies nearest. */
export function place_errors(problems: readonly FieldProblem[]): FormErrors {
  const errors: FormErrors = {};
  for (const problem of problems) {
    const below = kFields.filter((field) =>
      problem.pointer === field.pointer || problem.pointer.startsWith(`${field.pointer}/`));
    const spec = below.sort((a, b) => b.pointer.length - a.pointer.length)[0];
    const key = spec?.key ?? (problem.pointer.startsWith("/stop") ? "samples" : undefined);
    if (key && !errors[key]) errors[key] = problem.message;
  }
  return errors;
}
