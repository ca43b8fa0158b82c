// The picture on its stage: a canvas, sized to fit or to one image pixel per
// screen pixel. The old picture stays until the next one is decoded.

import { h, set_attribute, set_hidden, set_text } from "./dom";

export class Picture {
  private canvas_ = h("canvas", { role: "img", hidden: true });
  private waiting_ = h("p", { class: "waiting" });
  readonly stage = h("div",
    { class: "stage", tabindex: 0, role: "region", "aria-label": "Picture" },
    this.canvas_, this.waiting_);
  private zoom_: "fit" | "actual" = "fit";
  private frame_ = { width: 0, height: 0 };
  /** Called with the scale on screen: screen pixels per picture pixel. */
  on_scale: (scale: number) => void = () => undefined;

  constructor() {
    new ResizeObserver(() => this.layout()).observe(this.stage);
  }

  /** Size of the picture to come, known before its first pixel. */
  expect(width: number, height: number): void {
    if (width === this.frame_.width && height === this.frame_.height) return;
    this.frame_ = { width, height };
    this.layout();
  }

  describe(label: string, waiting: string): void {
    set_attribute(this.canvas_, "aria-label", label);
    set_text(this.waiting_, waiting);
    set_hidden(this.waiting_, waiting === "" || !this.canvas_.hidden);
  }

  clear(): void {
    set_hidden(this.canvas_, true);
    delete this.canvas_.dataset["revision"];
  }

  async show(blob: Blob, revision: number, exposure: number, still_wanted: () => boolean): Promise<void> {
    const bitmap = await createImageBitmap(blob);
    if (still_wanted()) {
      if (this.canvas_.width !== bitmap.width) this.canvas_.width = bitmap.width;
      if (this.canvas_.height !== bitmap.height) this.canvas_.height = bitmap.height;
      this.canvas_.getContext("2d")?.drawImage(bitmap, 0, 0);
      this.canvas_.dataset["revision"] = String(revision);
      this.canvas_.dataset["exposure"] = String(exposure);
      set_hidden(this.canvas_, false);
      set_hidden(this.waiting_, true);
      this.expect(bitmap.width, bitmap.height);
    }
    bitmap.close();
  }

  set_zoom(zoom: "fit" | "actual"): void {
    if (zoom === this.zoom_) return;
    this.zoom_ = zoom;
    this.layout();
  }

  private layout(): void {
    const { width, height } = this.frame_;
    if (width === 0 || this.stage.clientWidth === 0) return;
    const room = kStagePadding * 2;
    const fit = Math.min(
      (this.stage.clientWidth - room) / width, (this.stage.clientHeight - room) / height);
    const actual = 1 / window.devicePixelRatio;
    const scale = this.zoom_ === "fit" ? Math.max(fit, 0.01) : actual;
    this.canvas_.style.width = `${width * scale}px`;
    this.canvas_.style.height = `${height * scale}px`;
    this.canvas_.classList.toggle("coarse", scale / actual >= 2);
    this.on_scale(scale / actual);
  }
}

const kStagePadding = 16;
