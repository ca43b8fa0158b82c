// The dialog that lists the keyboard shortcuts.

import { kKeys, type Key } from "../keys";
import { h } from "./dom";

const row = (key: Key): HTMLElement =>
  h("div", {}, h("dt", {}, h("kbd", {}, key.key)), h("dd", {}, key.says));

export class Help {
  readonly element = h("dialog", { "aria-labelledby": "help-heading" },
    h("h2", { id: "help-heading" }, "Keyboard"),
    h("h3", {}, "Anywhere"),
    h("dl", { class: "keys" }, ...kKeys.filter((key) => key.where === "anywhere").map(row)),
    h("h3", {}, "On a job's page"),
    h("dl", { class: "keys" }, ...kKeys.filter((key) => key.where === "job").map(row)),
    h("form", { method: "dialog" }, h("button", { class: "primary" }, "Close")));

  open(): void {
    if (!this.element.open) this.element.showModal();
  }
}
