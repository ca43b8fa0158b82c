// What a person can ask for. The views call these; main carries them out.

import type { Layer } from "../contract";
import type { FormKey } from "../form";
import type { SceneFile } from "../upload_list";

export interface Commands {
  navigate(path: string): void;
  upload(files: Promise<SceneFile[]>): void;
  stop_upload(id: number): void;
  dismiss_upload(id: number): void;
  set_field(key: FormKey, value: string): void;
  submit(): void;
  show_older(): void;
  cancel(id: string): void;
  command_batch(id: string, what: "cancel" | "rerun"): void;
  render_again(id: string): void;
  /** Goes on with a completed job until its error is so small. */
  extend(id: string, error: number): void;
  set_exposure(stops: number): void;
  set_layer(layer: Layer): void;
  set_zoom(zoom: "fit" | "actual"): void;
  retry_now(): void;
}
