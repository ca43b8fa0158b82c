// The form for a new job. Inputs show the state; errors stand at their fields.

import { scene_title, type Scene } from "../contract";
import { kFields, kOwnCamera, kWithout, type FieldSpec, type FormKey } from "../form";
import { bytes, count } from "../format";
import type { State } from "../state";
import type { Commands } from "./commands";
import { Facts, h, set_attribute, set_hidden, set_text } from "./dom";
import { EffectList, EffectPicker } from "./effects";
import { LayerPicker } from "./layers";
import { WarningList } from "./warnings";

type Control = HTMLInputElement | HTMLSelectElement;
type Option = readonly [value: string, label: string];

class Field {
  readonly control: Control;
  readonly element: HTMLElement;
  private error_: HTMLElement;
  private options_ = "";

  constructor(readonly spec: FieldSpec, commands: Commands) {
    const id = `field-${spec.key}`;
    const described = `${id}-hint ${id}-error`;
    const select = ["scene", "camera", "choice"].includes(spec.kind);
    this.control = select
      ? h("select", { id, "aria-describedby": described })
      : h("input", {
        id, type: "text", autocomplete: "off", spellcheck: "false", "aria-describedby": described,
        inputmode: spec.kind === "integer" ? "numeric" : spec.kind === "number" ? "decimal" : "text",
      });
    this.error_ = h("p", { class: "field-error", id: `${id}-error` });
    this.element = h("div", { class: `field field-${spec.kind}` },
      h("label", { for: id }, spec.label, " ",
        h("span", { class: "hint", id: `${id}-hint` }, spec.hint)),
      this.control, this.error_);
    this.control.addEventListener(select ? "change" : "input", () =>
      commands.set_field(spec.key, this.control.value));
    if (spec.choices) this.offer(spec.choices);
  }

  offer(options: readonly Option[]): void {
    const key = JSON.stringify(options);
    if (key === this.options_) return;
    this.options_ = key;
    this.control.replaceChildren(...options.map(([value, label]) => h("option", { value }, label)));
  }

  update(value: string, error: string): void {
    if (this.control.value !== value) this.control.value = value;
    set_text(this.error_, error);
    set_hidden(this.error_, error === "");
    set_attribute(this.control, "aria-invalid", error ? "true" : null);
  }
}

export class JobForm {
  private fields_ = new Map<FormKey, Field>();
  private own_camera_ = h("fieldset", { class: "fields", hidden: true }, h("legend", {}, "Own camera"));
  private more_ = h("div", { class: "fields" });
  private details_ = h("details", {}, h("summary", {}, "More settings"), this.more_);
  private report_ = new Facts();
  private effects_ = new EffectList();
  private picker_: EffectPicker;
  private layers_: LayerPicker;
  private warnings_ = new WarningList();
  private problem_ = h("p", { class: "problem", role: "alert", hidden: true });
  private submit_ = h("button", { type: "submit", class: "primary" }, "Render");
  readonly element: HTMLFormElement;

  constructor(commands: Commands) {
    const main = h("div", { class: "fields" });
    this.picker_ = new EffectPicker((value) => commands.set_field("without", value));
    this.layers_ = new LayerPicker((value) => commands.set_field("layers", value));
    for (const spec of kFields) {
      if (spec.kind === "effects" || spec.kind === "layers") {
        this.more_.append((spec.kind === "effects" ? this.picker_ : this.layers_).element);
        continue;
      }
      const field = new Field(spec, commands);
      this.fields_.set(spec.key, field);
      const group = { main, camera: this.own_camera_, more: this.more_ }[spec.group];
      group.append(field.element);
      if (spec.key === "scene") main.append(this.report_.element, this.effects_.element, this.warnings_.element);
      if (spec.key === "camera") main.append(this.own_camera_);
    }
    this.element = h("form", { novalidate: true, "aria-label": "New render" },
      main, this.details_, this.problem_, this.submit_);
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      commands.submit();
    });
  }

  focus(): void {
    this.fields_.get("scene")?.control.focus();
  }

  /** Moves to the first field with an error, opening what hides it. */
  focus_error(): void {
    const bad = [...this.fields_.values()].find((field) => field.control.hasAttribute("aria-invalid"));
    const of_picker = !bad && this.picker_.element.hasAttribute("aria-invalid");
    if (bad?.spec.group === "more" || of_picker) this.details_.open = true;
    if (of_picker) this.picker_.focus();
    bad?.control.focus();
  }

  update(state: State): void {
    const scene = state.scenes[state.form.scene];
    this.fields_.get("scene")?.offer(scene_options(state));
    this.fields_.get("camera")?.offer(camera_options(scene));
    for (const [key, field] of this.fields_) {
      field.update(state.form[key], state.form_errors[key] ?? "");
    }
    set_hidden(this.own_camera_, state.form.camera !== kOwnCamera);
    this.picker_.update(state.form.without, state.form_errors.without ?? "", Object.values(state.scenes), scene);
    this.layers_.update(state.form.layers, state.form_errors.layers ?? "");
    set_hidden(this.picker_.element, state.form.effects !== kWithout);
    this.effects_.update(scene?.effects);
    this.report_.update(scene ? report(scene) : [], ["Lights"]);
    set_hidden(this.report_.element, !scene);
    this.warnings_.update(scene?.warnings ?? []);
    set_text(this.problem_, state.form_problem);
    set_hidden(this.problem_, state.form_problem === "");
    this.submit_.disabled = state.submitting;
    set_text(this.submit_, state.submitting ? "Submitting…" : "Render");
  }
}

function scene_options(state: State): Option[] {
  const scenes = Object.values(state.scenes)
    .sort((a, b) => b.created_at.localeCompare(a.created_at));
  const options: Option[] = scenes.map((scene) =>
    [scene.id, `${scene_title(scene)} · ${scene.id.slice(0, 6)}`]);
  if (state.form.scene && !state.scenes[state.form.scene]) {
    options.unshift([state.form.scene, `Unknown scene ${state.form.scene.slice(0, 8)}`]);
  }
  if (options.length > 0) return options;
  return [["", state.scenes_loaded ? "No scene yet: upload one" : "Loading…"]];
}

function camera_options(scene: Scene | undefined): Option[] {
  const cameras = scene?.cameras ?? [];
  const named: Option[] = cameras.map((camera) =>
    [String(camera.index), camera.name || `Camera ${camera.index + 1}`]);
  if (named.length === 0) named.push(["0", "Default view"]);
  return [...named, [kOwnCamera, "Own camera…"]];
}

/** What the import found, in the order in which people ask. */
export function report(scene: Scene): [string, string][] {
  const rows: [string, string][] = [
    ["Triangles", count(scene.triangles)],
    ["Materials", count(scene.materials)],
    ["Upload", bytes(scene.bytes)],
  ];
  if (scene.dropped_triangles) rows.push(["Zero area", `${count(scene.dropped_triangles)} dropped`]);
  rows.push(["Lights", lights(scene)]);
  return rows;
}

function lights(scene: Scene): string {
  const { point, spot = 0, directional = 0, environment, emitting_triangles: emitting } = scene.lights;
  const parts: string[] = [];
  if (point > 0) parts.push(`${count(point)} point`);
  if (spot > 0) parts.push(`${count(spot)} spot`);
  if (directional > 0) parts.push(`${count(directional)} directional`);
  if (environment) parts.push("environment map");
  if (emitting > 0) parts.push(`${count(emitting)} emitting ${emitting === 1 ? "triangle" : "triangles"}`);
  return parts.join(", ") || "none: only the background shines";
}

