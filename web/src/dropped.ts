// From the browser's file pickers and drops to scene files with their paths.

import type { SceneFile } from "./upload_list";

/** Bound on files of one drop; the server takes 256 parts, archives count as one. */
const kMostFiles = 2000;

export function files_of_input(list: FileList | null): SceneFile[] {
  return Array.from(list ?? []).map((file) => ({ path: file.webkitRelativePath || file.name, file }));
}

/** Must be called inside the drop event: the entries are gone after it. */
export function files_of_drop(transfer: DataTransfer): Promise<SceneFile[]> {
  const entries = Array.from(transfer.items)
    .filter((item) => item.kind === "file")
    .map((item) => item.webkitGetAsEntry?.() ?? null);
  const plain = files_of_input(transfer.files);
  if (!entries.some((entry) => entry?.isDirectory)) return Promise.resolve(plain);
  return walk(entries.filter((entry) => entry !== null));
}

async function walk(roots: FileSystemEntry[]): Promise<SceneFile[]> {
  const found: SceneFile[] = [];
  const open = [...roots];
  for (let entry = open.shift(); entry && found.length < kMostFiles; entry = open.shift()) {
    const path = entry.fullPath.replace(/^\//, "");
    if (entry.isFile) found.push({ path, file: await file_of(entry as FileSystemFileEntry) });
    else open.push(...(await children_of(entry as FileSystemDirectoryEntry)));
  }
  return found;
}

const file_of = (entry: FileSystemFileEntry): Promise<File> =>
  new Promise((resolve, reject) => entry.file(resolve, reject));

async function children_of(folder: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = folder.createReader();
  const all: FileSystemEntry[] = [];
  for (;;) {
    // Chromium hands out at most 100 entries a call; an empty answer is the end.
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) =>
      reader.readEntries(resolve, reject));
    if (some.length === 0 || all.length >= kMostFiles) return all;
    all.push(...some);
  }
}
