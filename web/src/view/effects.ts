// Which effects are simulated, and why; and the choice of what to leave out.

import type { EffectLine, EffectReport, Scene } from "../contract";
import { is_chosen, toggled } from "../form";
import { label_of } from "../format";
import { h, set_attribute, set_children, set_hidden, set_text } from "./dom";

/** What became of an effect, in words. */
export function verdict(line: EffectLine): string {
  if (line.simulated) return line.called_for ? "simulated" : "simulated, though not called for";
  return line.called_for ? "left out on request" : "left out";
}

/** Why, and what that means for the picture. */
export function reason(line: EffectLine): string {
  if (line.simulated) return line.evidence;
  const grade = line.called_for ? `${line.grade}: the picture is another one` : "the picture is the same";
  return `${line.evidence}. Without ${line.left_out}; ${grade}.`;
}

/** Called-for ones that are left out first, then what is simulated, then the rest. */
export function in_order(list: readonly EffectLine[]): EffectLine[] {
  const rank = (line: EffectLine): number => (line.simulated ? 1 : line.called_for ? 0 : 2);
  return [...list].sort((a, b) => rank(a) - rank(b));
}

/** The list of a report, folded away under a summary that says what it holds. */
export class EffectList {
  private title_ = h("summary");
  private list_ = h("ul", { class: "effects" });
  readonly element = h("details", { class: "effects-fold", hidden: true }, this.title_, this.list_);
  private shown_ = "";

  update(report: EffectReport | null | undefined): void {
    set_hidden(this.element, !report);
    const key = JSON.stringify(report ?? null);
    if (!report || key === this.shown_) return;
    this.shown_ = key;
    const simulated = report.list.filter((line) => line.simulated).length;
    const mark = report.approximation ? ", approximation" : "";
    set_text(this.title_, `Effects: ${simulated} of ${report.list.length} simulated${mark}`);
    if (report.approximation) this.element.open = true;
    this.list_.replaceChildren(...in_order(report.list).map((line) =>
      h("li", { "data-effect": line.effect, "data-simulated": String(line.simulated) },
        h("strong", {}, label_of(line.effect)), " ", h("span", { class: "verdict" }, verdict(line)),
        h("p", { class: "hint" }, reason(line)))));
  }
}

class Choice {
  private box_: HTMLInputElement;
  private note_ = h("span", { class: "hint" });
  readonly element: HTMLElement;

  constructor(readonly name: string, change: (on: boolean) => void) {
    const id = `without-${name}`;
    this.box_ = h("input", { type: "checkbox", id });
    this.box_.addEventListener("change", () => change(this.box_.checked));
    this.element = h("div", { class: "choice" }, this.box_, h("label", { for: id }, label_of(name), " ", this.note_));
  }

  update(chosen: boolean, called_for: boolean): void {
    if (this.box_.checked !== chosen) this.box_.checked = chosen;
    set_text(this.note_, called_for ? "called for" : "");
  }
}

/** Check boxes for what to leave out; the value is the names, separated by commas. */
export class EffectPicker {
  private error_ = h("p", { class: "field-error", id: "field-without-error" });
  private rows_ = h("div", { class: "choices" });
  readonly element = h("fieldset", { class: "fields", id: "field-without", "aria-describedby": "field-without-error" },
    h("legend", {}, "Leave out"), this.rows_, this.error_);
  private choices_ = new Map<string, Choice>();
  private value_ = "";

  constructor(private change_: (value: string) => void) {}

  /** `scene` knows what it calls for; the names are the same for every scene. */
  update(value: string, error: string, scenes: readonly Scene[], scene: Scene | undefined): void {
    this.value_ = value;
    const list = (scene?.effects ?? scenes.find((one) => one.effects)?.effects)?.list ?? [];
    const called_for = new Set(scene?.effects?.list.filter((line) => line.called_for).map((line) => line.effect));
    const all = [...new Set([...list.map((line) => line.effect), ...value.split(",").filter((name) => name !== "")])];
    set_children(this.rows_, all.map((name) => {
      const choice = this.choices_.get(name) ??
        new Choice(name, (on) => this.change_(toggled(this.value_, name, on)));
      this.choices_.set(name, choice);
      choice.update(is_chosen(value, name), called_for.has(name));
      return choice.element;
    }));
    set_text(this.error_, error);
    set_hidden(this.error_, error === "");
    set_attribute(this.element, "aria-invalid", error ? "true" : null);
  }

  focus(): void {
    this.rows_.querySelector("input")?.focus();
  }
}
