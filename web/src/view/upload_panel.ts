// Choosing files and the progress of what is being sent.

import type { Upload } from "../state";
import { bytes, percent } from "../format";
import { explain } from "../problem";
import { files_of_input } from "../dropped";
import type { Commands } from "./commands";
import { h, set_attribute, set_children, set_class, set_hidden, set_text } from "./dom";

class UploadRow {
  private title_ = h("span", { class: "upload-title" });
  private status_ = h("span", { class: "upload-status" });
  private bar_ = h("progress", { max: 1, value: 0 });
  private reason_ = h("p", { class: "problem", role: "alert", hidden: true });
  private stop_ = h("button", { type: "button", class: "quiet" }, "Stop");
  private dismiss_ = h("button", { type: "button", class: "quiet" }, "Dismiss");
  readonly element = h("li", { class: "upload" },
    h("div", { class: "upload-head" }, this.title_, this.status_, this.stop_, this.dismiss_),
    this.bar_, this.reason_);

  constructor(id: number, commands: Commands) {
    this.stop_.addEventListener("click", () => commands.stop_upload(id));
    this.dismiss_.addEventListener("click", () => commands.dismiss_upload(id));
  }

  update(upload: Upload): void {
    const fraction = upload.total > 0 ? upload.sent / upload.total : 0;
    set_text(this.title_, upload.files > 1 ? `${upload.label} and ${upload.files - 1} more` : upload.label);
    set_text(this.status_, {
      sending: `${percent(Math.min(fraction, 0.999))} of ${bytes(upload.total)}`,
      importing: "reading the scene…",
      done: "ready",
      failed: "refused",
    }[upload.phase]);
    set_attribute(this.bar_, "aria-label", `Upload of ${upload.label}`);
    if (upload.phase === "importing") this.bar_.removeAttribute("value");
    else this.bar_.value = upload.phase === "done" ? 1 : fraction;
    const busy = upload.phase === "sending" || upload.phase === "importing";
    set_hidden(this.bar_, !busy);
    set_hidden(this.stop_, !busy);
    set_hidden(this.dismiss_, busy);
    set_attribute(this.stop_, "aria-label", `Stop the upload of ${upload.label}`);
    set_attribute(this.dismiss_, "aria-label", `Dismiss the upload of ${upload.label}`);
    set_class(this.element, "failed", upload.phase === "failed");
    set_text(this.reason_, upload.problem ? explain(upload.problem) : "");
    set_hidden(this.reason_, !upload.problem);
  }
}

export class UploadPanel {
  private rows_ = new Map<number, UploadRow>();
  private list_ = h("ul", { class: "uploads", "aria-label": "Uploads" });
  private files_ = h("input", {
    type: "file", multiple: true, hidden: true, id: "pick-files", "aria-label": "Scene files",
  });
  private folder_ = h("input", {
    type: "file", webkitdirectory: true, hidden: true, id: "pick-folder", "aria-label": "Scene folder",
  });
  readonly element: HTMLElement;

  constructor(private commands_: Commands) {
    for (const input of [this.files_, this.folder_]) {
      input.addEventListener("change", () => {
        commands_.upload(Promise.resolve(files_of_input(input.files)));
        input.value = "";
      });
    }
    const choose = h("button", { type: "button", onclick: () => this.choose() }, "Choose files…");
    const folder = h("button", { type: "button", class: "quiet", onclick: () => this.folder_.click() },
      "or a folder");
    this.element = h("section", { "aria-labelledby": "upload-heading" },
      h("h2", { id: "upload-heading" }, "Scene"),
      h("div", { class: "drop-target" },
        h("p", { class: "drop-lead" }, "Drop a scene anywhere on this page"),
        h("p", { class: "hint" }, "A .zip or .glb, or an .obj or .gltf with its files"),
        h("div", { class: "row" }, choose, folder), this.files_, this.folder_),
      this.list_);
  }

  choose(): void {
    this.files_.click();
  }

  update(uploads: readonly Upload[]): void {
    const rows = uploads.map((upload) => {
      const row = this.rows_.get(upload.id) ?? new UploadRow(upload.id, this.commands_);
      this.rows_.set(upload.id, row);
      row.update(upload);
      return row.element;
    });
    set_children(this.list_, rows);
    set_hidden(this.list_, rows.length === 0);
  }
}
