// Errors as the server states them: RFC 9457 problem documents with a stable
// code, and for bad fields a list of JSON pointers with a reason each.

export interface FieldProblem {
  pointer: string;
  message: string;
}

export class Problem extends Error {
  constructor(
    /** HTTP status; 0 when no answer came. */
    readonly status: number,
    readonly code: string,
    readonly title: string,
    readonly detail: string,
    /** File and line, archive entry or parameter that the detail speaks of. */
    readonly where: string = "",
    readonly fields: readonly FieldProblem[] = [],
    /** Seconds after which the server asks to be tried again. */
    readonly retry_after: number | null = null,
  ) {
    super(detail || title);
    this.name = "Problem";
  }
}

type Bag = Record<string, unknown>;

const text = (value: unknown): string => (typeof value === "string" ? value : "");

function field_problem(value: unknown): FieldProblem | null {
  if (typeof value !== "object" || value === null) return null;
  const bag = value as Bag;
  const pointer = text(bag["pointer"]);
  const message = text(bag["detail"]) || text(bag["message"]) || text(bag["title"]);
  return pointer || message ? { pointer, message: message || "is not acceptable" } : null;
}

/** Reads an error body of any shape; a proxy's HTML page still gives a sentence. */
export function parse_problem(status: number, body: string, retry_after: string | null): Problem {
  let bag: Bag = {};
  try {
    const parsed: unknown = JSON.parse(body);
    if (typeof parsed === "object" && parsed !== null) bag = parsed as Bag;
  } catch {
    // not JSON: the status alone has to do
  }
  const list = Array.isArray(bag["errors"]) ? bag["errors"] : [];
  const fields = list.map(field_problem).filter((entry) => entry !== null);
  const seconds = retry_after === null ? Number.NaN : Number(retry_after);
  return new Problem(
    status,
    text(bag["code"]) || `http_${status}`,
    text(bag["title"]) || default_title(status),
    text(bag["detail"]),
    text(bag["where"]),
    fields,
    Number.isFinite(seconds) && seconds >= 0 ? seconds : null,
  );
}

function default_title(status: number): string {
  if (status === 404) return "Not found";
  if (status === 413) return "Too large for this server";
  if (status === 429 || status === 503) return "The server is busy";
  return status >= 500 ? "The server failed" : `The server refused the request (${status})`;
}

export function unreachable(): Problem {
  return new Problem(0, "unreachable", "The server does not answer", "");
}

/** What happened and what to do about it, as sentences for people. */
export function explain(problem: Problem): string {
  const what = problem.detail || problem.title;
  const parts = [problem.where ? `${problem.where}: ${what}` : what];
  const remedy = remedy_of(problem.code);
  if (remedy) parts.push(remedy);
  if (problem.retry_after !== null) {
    parts.push(`Try again in ${Math.max(1, Math.ceil(problem.retry_after))} s.`);
  }
  return parts.map((part) => (/[.!?]$/.test(part) ? part : `${part}.`)).join(" ");
}

const kRemedies: Record<string, string> = {
  unreachable: "Check that raykilnd is running.",
  payload_too_large: "Leave out files the scene does not need, or raise the server's upload limit.",
  unsupported_media_type: "Send a .zip, a .glb, or an .obj or .gltf with the files it names.",
  film_too_large: "Choose a smaller width or height.",
  tree_too_large: "Allow the tree more memory, or leave the limit empty.",
  archive_invalid: "Pack the scene again as an ordinary zip and check that the file is whole.",
  archive_too_large: "Pack fewer or smaller files.",
  unsafe_name: "Rename the file: relative paths with forward slashes only.",
  scene_invalid: "Correct the file and upload the scene again.",
  scene_unsupported: "Supported are OBJ with MTL and glTF 2.0; export the scene as one of these.",
  scene_empty: "Check that the export contains triangles.",
  scene_too_large: "Simplify the mesh or split the scene.",
  queue_full: "Wait until a job has finished, or cancel one.",
  scene_not_found: "Upload the scene again.",
  render_failed: "Render again; if it fails again, try a smaller picture and read the server's log.",
  internal: "The server's log has the cause.",
  storage_full: "Free room in the server's store.",
};

/** What a person can do about an error code; empty when there is nothing to say. */
export const remedy_of = (code: string): string => kRemedies[code] ?? "";
