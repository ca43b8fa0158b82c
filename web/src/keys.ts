// Keyboard shortcuts: one table for the handler and for the help.

export type Shortcut =
  | "help" | "home" | "batches" | "upload" | "form" | "darker" | "brighter" | "reset" | "fit" | "actual"
  | "cancel" | "again" | "png" | "exr";

export interface Key {
  key: string;
  does: Shortcut;
  says: string;
  where: "anywhere" | "job";
}

export const kKeys: readonly Key[] = [
  { key: "?", does: "help", says: "Show this help", where: "anywhere" },
  { key: "h", does: "home", says: "All jobs", where: "anywhere" },
  { key: "b", does: "batches", says: "All batches", where: "anywhere" },
  { key: "u", does: "upload", says: "Choose scene files", where: "anywhere" },
  { key: "n", does: "form", says: "New render", where: "anywhere" },
  { key: "[", does: "darker", says: "Half a stop darker", where: "job" },
  { key: "]", does: "brighter", says: "Half a stop brighter", where: "job" },
  { key: "0", does: "reset", says: "Reset the exposure", where: "job" },
  { key: "f", does: "fit", says: "Fit the picture", where: "job" },
  { key: "1", does: "actual", says: "One picture pixel per screen pixel", where: "job" },
  { key: "C", does: "cancel", says: "Cancel the render (Shift + C)", where: "job" },
  { key: "r", does: "again", says: "Render again", where: "job" },
  { key: "p", does: "png", says: "Download the PNG", where: "job" },
  { key: "e", does: "exr", says: "Download the EXR", where: "job" },
];

export interface KeyPress {
  key: string;
  ctrlKey: boolean;
  metaKey: boolean;
  altKey: boolean;
}

/** The shortcut of a key press, or null. `typing`: a text field or list has the focus. */
export function shortcut(press: KeyPress, on_job: boolean, typing: boolean): Shortcut | null {
  if (press.ctrlKey || press.metaKey || press.altKey || typing) return null;
  const found = kKeys.find((key) => key.key === press.key && (key.where === "anywhere" || on_job));
  return found?.does ?? null;
}
