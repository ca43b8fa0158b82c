// Typed client of the server's HTTP API. Every failure is a Problem.

import {
  is_batch, is_batch_summary, is_job, is_scene, type Batch, type BatchSummary, type Job, type JobAccuracy, type JobPage, type JobRequest, type Layer, type Scene,
} from "./contract";
import { parse_problem, Problem, unreachable } from "./problem";
import type { UploadPlan } from "./upload_list";

const kJson = { Accept: "application/json, application/problem+json" };

export async function problem_of(answer: Response): Promise<Problem> {
  const body = await answer.text().catch(() => ""); // a cut body still has its status
  return parse_problem(answer.status, body, answer.headers.get("Retry-After"));
}

async function call(path: string, options: RequestInit = {}): Promise<Response> {
  let answer: Response;
  try {
    answer = await fetch(path, { ...options, headers: { ...kJson, ...options.headers } });
  } catch (error) {
    if (options.signal?.aborted) throw error;
    throw unreachable();
  }
  if (!answer.ok) throw await problem_of(answer);
  return answer;
}

async function json(path: string, options?: RequestInit): Promise<unknown> {
  const answer = await call(path, options);
  try {
    return await answer.json();
  } catch {
    throw new Problem(answer.status, "bad_answer", "The server's answer is not JSON", "");
  }
}

type Bag = Record<string, unknown>;

const list_in = (value: unknown, name: string): unknown[] => {
  const list = (value as Bag | null)?.[name];
  return Array.isArray(list) ? list : [];
};

/** One page of jobs, newest first; `cursor` is the `next_cursor` of the page before. */
export async function list_jobs(cursor: string | null, signal?: AbortSignal): Promise<JobPage> {
  const query = cursor === null ? "" : `?cursor=${encodeURIComponent(cursor)}`;
  const value = await json(`/v1/jobs${query}`, signal ? { signal } : {});
  const next = (value as Bag | null)?.["next_cursor"];
  return {
    jobs: list_in(value, "jobs").filter(is_job),
    next_cursor: typeof next === "string" ? next : null,
  };
}

/** The newest scenes; the form offers no more than one page of them. */
export async function list_scenes(): Promise<Scene[]> {
  return list_in(await json("/v1/scenes?limit=200"), "scenes").filter(is_scene);
}

export async function get_scene(id: string): Promise<Scene> {
  return (await json(`/v1/scenes/${encodeURIComponent(id)}`)) as Scene;
}

export async function get_job(id: string, signal?: AbortSignal): Promise<Job> {
  return as_job(await json(job_path(id), signal ? { signal } : {}));
}

export async function submit_job(request: JobRequest, idempotency_key: string): Promise<Job> {
  return as_job(
    await json("/v1/jobs", {
      method: "POST",
      headers: { "Content-Type": "application/json", "Idempotency-Key": idempotency_key },
      body: JSON.stringify(request),
    }),
  );
}

export async function cancel_job(id: string): Promise<Job> {
  return as_job(await json(`${job_path(id)}/cancel`, { method: "POST" }));
}

/** More samples for a completed job, until its error is so small: a new job. */
export async function extend_job(id: string, error: number): Promise<Job> {
  return as_job(
    await json(`${job_path(id)}/extend`, {
      method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ stop: { error } }),
    }),
  );
}

/** The newest batches: one page of them. */
export async function list_batches(signal?: AbortSignal): Promise<BatchSummary[]> {
  return list_in(await json("/v1/batches", signal ? { signal } : {}), "batches").filter(is_batch_summary);
}

const batch_path = (id: string): string => `/v1/batches/${encodeURIComponent(id)}`;

export async function get_batch(id: string, signal?: AbortSignal): Promise<Batch> {
  return as_batch(await json(batch_path(id), signal ? { signal } : {}));
}

export async function command_batch(id: string, what: "cancel" | "rerun"): Promise<Batch> {
  return as_batch(await json(`${batch_path(id)}/${what}`, { method: "POST" }));
}

function as_batch(value: unknown): Batch {
  if (is_batch(value)) return value;
  throw new Problem(200, "bad_answer", "The server's answer is not a batch", "");
}

function as_job(value: unknown): Job {
  if (is_job(value)) return value;
  throw new Problem(200, "bad_answer", "The server's answer is not a job", "");
}

export const job_path = (id: string): string => `/v1/jobs/${encodeURIComponent(id)}`;

export async function get_accuracy(id: string): Promise<JobAccuracy> {
  return (await json(`${job_path(id)}/accuracy`)) as JobAccuracy;
}

export function image_url(
  id: string, format: "png" | "exr", exposure = 0, revision?: number, layer: Layer = "beauty",
): string {
  const query = new URLSearchParams({ format });
  if (layer !== "beauty") query.set("layer", layer);
  if (exposure !== 0) query.set("exposure", String(exposure));
  if (revision !== undefined) query.set("rev", String(revision));
  return `${job_path(id)}/image?${query}`;
}

export interface UploadHandle {
  done: Promise<Scene>;
  abort(): void;
}

/** Sends a scene. fetch() reports no upload progress, hence XMLHttpRequest. */
export function upload_scene(
  plan: UploadPlan, on_progress: (sent: number, total: number) => void,
): UploadHandle {
  const request = new XMLHttpRequest();
  const done = new Promise<Scene>((resolve, reject) => {
    request.open("POST", `/v1/scenes?name=${encodeURIComponent(plan.name)}`);
    request.setRequestHeader("Accept", kJson.Accept);
    request.upload.onprogress = (event) => {
      on_progress(event.loaded, event.lengthComputable ? event.total : plan.total_bytes);
    };
    request.onerror = () => reject(unreachable());
    request.onabort = () => reject(new Problem(0, "aborted", "The upload was stopped", "You stopped it."));
    request.onload = () => settle_upload(request, resolve, reject);
    const first = plan.files[0];
    if (plan.kind === "raw" && first) {
      request.setRequestHeader("Content-Type", plan.media_type);
      request.send(first.file);
    } else {
      const form = new FormData();
      for (const entry of plan.files) form.append("file", entry.file, entry.path);
      request.send(form);
    }
  });
  return { done, abort: () => request.abort() };
}

function settle_upload(
  request: XMLHttpRequest, resolve: (scene: Scene) => void, reject: (problem: Problem) => void,
): void {
  if (request.status < 200 || request.status > 299) {
    const retry_after = request.getResponseHeader("Retry-After");
    reject(parse_problem(request.status, request.responseText, retry_after));
    return;
  }
  try {
    resolve(JSON.parse(request.responseText) as Scene);
  } catch {
    reject(new Problem(request.status, "bad_answer", "The server's answer is not JSON", ""));
  }
}
