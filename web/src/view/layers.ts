// Layers beside the picture: choosing them in the form, and what the stage says of them.

import { kAskedLayers, type AskedLayer, type Layer, type MapRange } from "../contract";
import { is_chosen, toggled } from "../form";
import { h, set_attribute, set_hidden, set_text } from "./dom";

export const kLayerNames: Record<Layer, string> = {
  beauty: "Picture", error: "Standard error", samples: "Samples", seconds: "Seconds",
  albedo: "Albedo", normal: "Normal", depth: "Depth", object_id: "Object", material_id: "Material",
  emission: "Emission", direct: "Direct light", indirect: "Indirect light",
};

const kUnits: Partial<Record<Layer, string>> = { error: " radiance", samples: " samples", seconds: " s", depth: " m" };

const kNotes: Partial<Record<Layer, string>> = {
  albedo: "share of light that the first surface sends on",
  normal: "x, y, z: −1 to 1 as red, green, blue",
  object_id: "a colour for each object; black: none",
  material_id: "a colour for each material; black: none",
  emission: "light of what is seen itself",
  direct: "light straight from where it is emitted",
  indirect: "light after more than one scattering",
};

const range_number = (value: number): string => String(Number(value.toPrecision(2)));

/** What is shown; empty where nothing needs to be said. */
export function legend(layer: Layer, range: MapRange | null): string {
  if (!range) return kNotes[layer] ?? "";
  const log = range.scale === "log" ? ", logarithmic" : "";
  return `${range_number(range.low)} to ${range_number(range.high)}${kUnits[layer] ?? ""}${log}`;
}

/** Check boxes; the value is the names, separated by commas. */
export class LayerPicker {
  private error_ = h("p", { class: "field-error", id: "field-layers-error" });
  private boxes_ = new Map<AskedLayer, HTMLInputElement>();
  readonly element = h("fieldset", { class: "fields", id: "field-layers", "aria-describedby": "field-layers-error" },
    h("legend", {}, "Layers"));
  private value_ = "";

  constructor(change: (value: string) => void) {
    const rows = kAskedLayers.map((layer) => {
      const id = `layer-${layer}`;
      const box = h("input", { type: "checkbox", id });
      box.addEventListener("change", () => change(toggled(this.value_, layer, box.checked)));
      this.boxes_.set(layer, box);
      return h("div", { class: "choice" }, box, h("label", { for: id }, kLayerNames[layer]));
    });
    this.element.append(h("div", { class: "choices" }, ...rows), this.error_);
  }

  update(value: string, error: string): void {
    this.value_ = value;
    for (const [layer, box] of this.boxes_) box.checked = is_chosen(value, layer);
    set_text(this.error_, error);
    set_hidden(this.error_, error === "");
    set_attribute(this.element, "aria-invalid", error ? "true" : null);
  }
}
