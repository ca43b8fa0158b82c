// What to send for a set of dropped or picked files. Archives and .glb files
// are scenes of their own and go as they are; loose files (an .obj with its
// .mtl, a .gltf with its buffers) belong together and go as one multipart.

export interface SceneFile {
  /** Path inside the scene, with forward slashes. */
  path: string;
  file: Blob;
}

export interface UploadPlan {
  kind: "raw" | "multipart";
  /** File name of the archive or of the root file, as shown while it is sent. */
  label: string;
  /** Name that the scene gets: the label without its extension. */
  name: string;
  media_type: string;
  files: SceneFile[];
  total_bytes: number;
}

const kNoise = /(^|\/)(\.[^/]+|__MACOSX|Thumbs\.db|desktop\.ini)(\/|$)/i;
const kAlone: Record<string, string> = { zip: "application/zip", glb: "model/gltf-binary" };
const kMain = ["obj", "gltf", "glb"];

const extension = (path: string): string => /\.([^./]+)$/.exec(path)?.[1]?.toLowerCase() ?? "";
const base_name = (path: string): string => path.slice(path.lastIndexOf("/") + 1);

/** Removes the folders that all paths share, so that a dropped folder's name does not matter. */
export function strip_common_folder(paths: readonly string[]): string[] {
  const split = paths.map((path) => path.split("/").filter((part) => part !== ""));
  let depth = 0;
  for (;;) {
    const part = split[0]?.[depth];
    const all = part !== undefined &&
      split.every((parts) => parts.length > depth + 1 && parts[depth] === part);
    if (!all) break;
    depth += 1;
  }
  return split.map((parts) => parts.slice(depth).join("/"));
}

/** At most 200 bytes of UTF-8 without control characters, as the contract asks. */
export function scene_name(label: string): string {
  let name = label.replace(/\.[^.]+$/, "").replace(/[\u0000-\u001f\u007f]/g, " ");
  while (new TextEncoder().encode(name).length > 200) name = name.slice(0, -1);
  return name.replace(/[\ud800-\udbff]$/, "");
}

export function plan_uploads(files: readonly SceneFile[]): UploadPlan[] {
  const wanted = files
    .map((entry) => ({ ...entry, path: entry.path.replaceAll("\\", "/") }))
    .filter((entry) => !kNoise.test(entry.path));
  const has_sidecar = wanted.some((entry) => base_name(entry.path) === "raykiln.json");
  const is_alone = (entry: SceneFile): boolean =>
    extension(entry.path) in kAlone && !(has_sidecar && extension(entry.path) === "glb");
  const plans = wanted.filter(is_alone).map(raw_plan);
  const together = wanted.filter((entry) => !is_alone(entry));
  if (together.length > 0) plans.push(multipart_plan(together));
  return plans;
}

function raw_plan(entry: SceneFile): UploadPlan {
  return {
    kind: "raw",
    label: base_name(entry.path),
    name: scene_name(base_name(entry.path)),
    media_type: kAlone[extension(entry.path)] ?? "application/octet-stream",
    files: [{ path: base_name(entry.path), file: entry.file }],
    total_bytes: entry.file.size,
  };
}

function multipart_plan(entries: SceneFile[]): UploadPlan {
  const paths = strip_common_folder(entries.map((entry) => entry.path));
  const files = entries
    .map((entry, index) => ({ path: paths[index] ?? entry.path, file: entry.file }))
    .sort((a, b) => (a.path < b.path ? -1 : a.path > b.path ? 1 : 0));
  const main = files.find((entry) => kMain.includes(extension(entry.path))) ?? files[0];
  const label = main ? base_name(main.path) : "files";
  return {
    kind: "multipart",
    label,
    name: scene_name(label),
    media_type: "multipart/form-data",
    files,
    total_bytes: files.reduce((sum, entry) => sum + entry.file.size, 0),
  };
}
