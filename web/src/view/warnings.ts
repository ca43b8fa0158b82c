// Warnings of a scene or job as a list; equal ones are counted, not repeated.

import type { Warning } from "../contract";
import { h, set_hidden, set_text } from "./dom";

const kShown = 6;

/** One line a distinct message, with its first place and how often it occurs. */
export function warning_lines(warnings: readonly Warning[]): string[] {
  const groups = new Map<string, { where: string; times: number }>();
  for (const warning of warnings) {
    const text = warning.message || warning.code;
    const group = groups.get(text);
    const times = warning.count ?? 1;
    if (group) group.times += times;
    else groups.set(text, { where: warning.where, times });
  }
  const lines = [...groups].map(([text, group]) => {
    const place = group.where ? ` (${group.where}${group.times > 1 ? " and elsewhere" : ""})` : "";
    return `${text}${place}${group.times > 1 ? ` × ${group.times}` : ""}`;
  });
  if (lines.length <= kShown) return lines;
  return [...lines.slice(0, kShown), `and ${lines.length - kShown} more kinds of warning`];
}

export class WarningList {
  private list_ = h("ul");
  private title_ = h("h3");
  readonly element = h("section", { class: "warnings", hidden: true }, this.title_, this.list_);
  private shown_ = "";

  update(warnings: readonly Warning[]): void {
    const lines = warning_lines(warnings);
    const key = lines.join("\n");
    if (key === this.shown_) return;
    this.shown_ = key;
    set_text(this.title_, lines.length === 1 ? "1 warning" : `${lines.length} warnings`);
    this.list_.replaceChildren(...lines.map((line) => h("li", {}, line)));
    set_hidden(this.element, lines.length === 0);
  }
}
