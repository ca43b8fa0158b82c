import { describe, expect, test } from "vitest";
import type { Batch } from "../src/contract";
import { kDefaultForm } from "../src/form";
import { Problem } from "../src/problem";
import { initial_state, jobs_in_order, newer_job, reduce, since_heard, type Action, type State } from "../src/state";
import { job, kScene } from "./sample";

const start = (): State => initial_state({ page: "home" }, 1000);
const run = (...actions: Action[]): State => actions.reduce(reduce, start());
const problem = new Problem(422, "invalid_request", "Unprocessable", "1 field is wrong", "",
  [{ pointer: "/width", message: "too wide" }]);

describe("newer_job", () => {
  const old = job({ revision: 5 });
  test.each([
    ["a higher revision replaces", old, job({ revision: 6 }), true],
    ["a lower one does not", old, job({ revision: 4 }), false],
    ["the same refreshes the clocks", old, job({ revision: 5, elapsed_seconds: 3 }), true],
    ["a final state is never left", job({ state: "completed", revision: 5 }), job({ revision: 6 }), false],
    ["a final state is not replaced by itself", job({ state: "failed" }), job({ state: "failed" }), false],
  ])("%s", (_name, known, news, replaced) => {
    expect(newer_job(known, news)).toBe(replaced ? news : known);
  });
});

describe("jobs", () => {
  test("the list is newest first and keeps older pages", () => {
    const state = run(
      { type: "jobs", page: { jobs: [job({ id: "b", created_at: "2026-01-02T00:00:00Z" })], next_cursor: "c1" }, older: false, now_ms: 1 },
      { type: "jobs", page: { jobs: [job({ id: "a" })], next_cursor: null }, older: true, now_ms: 2 },
      { type: "jobs", page: { jobs: [job({ id: "c", created_at: "2026-01-03T00:00:00Z" })], next_cursor: "c1" }, older: false, now_ms: 3 });
    expect(jobs_in_order(state).map((one) => one.id)).toEqual(["c", "b", "a"]);
    expect(state.older_cursor).toBeNull(); // the refreshed first page does not bring the button back
  });

  test("late news does not undo the end", () => {
    const state = run(
      { type: "job", job: job({ state: "completed", revision: 9 }), now_ms: 1 },
      { type: "job", job: job({ state: "rendering", revision: 8 }), now_ms: 2 });
    expect(state.jobs["j_1"]?.state).toBe("completed");
  });

  test("clocks run between events, not when lost or final", () => {
    const live = { ...run({ type: "job", job: job(), now_ms: 1000 }, { type: "tick", now_ms: 3500 }) };
    expect(since_heard(live, job())).toBe(2.5);
    expect(since_heard({ ...live, line: { state: "lost", retry_at_ms: 0, reason: "" } }, job())).toBe(0);
    expect(since_heard(live, job({ state: "completed" }))).toBe(0);
    expect(since_heard(live, job({ started_at: null }))).toBe(0);
  });

  test("another place starts with a neutral exposure", () => {
    const state = run({ type: "exposure", value: 2 }, { type: "zoom", value: "actual" },
      { type: "route", route: { page: "job", id: "x" } });
    expect([state.exposure, state.zoom, state.line.state]).toEqual([0, "fit", "connecting"]);
  });
});

describe("uploads", () => {
  const begun: Action = { type: "upload_started", id: 1, label: "a.zip", files: 1, total: 10 };

  test("sent is not yet read", () => {
    expect(run(begun, { type: "upload_progress", id: 1, sent: 5, total: 10 }).uploads[0]?.phase).toBe("sending");
    expect(run(begun, { type: "upload_progress", id: 1, sent: 10, total: 10 }).uploads[0]?.phase).toBe("importing");
  });

  test("a scene that is ready is chosen, with its first camera", () => {
    const state = run(begun, { type: "form", key: "camera", value: "1" }, { type: "upload_done", id: 1, scene: kScene });
    expect(state.form.scene).toBe(kScene.id);
    expect(state.form.camera).toBe("0");
    expect(state.uploads[0]?.phase).toBe("done");
  });

  test("a refusal stays until it is dismissed", () => {
    const failed = run(begun, { type: "upload_failed", id: 1, problem });
    expect(failed.uploads[0]?.problem).toBe(problem);
    expect(reduce(failed, { type: "upload_dismissed", id: 1 }).uploads).toEqual([]);
  });

  test("the list of uploads is bounded", () => {
    let state = start();
    for (let id = 0; id < 50; id += 1) state = reduce(state, { ...begun, id });
    expect(state.uploads.length).toBe(8);
    expect(state.uploads[0]?.id).toBe(49);
  });
});

describe("form", () => {
  test("the newest scene is chosen when none is", () => {
    expect(run({ type: "scenes", scenes: [kScene] }).form.scene).toBe(kScene.id);
  });

  test("scenes that arrive later do not change a choice", () => {
    const state = run({ type: "form", key: "scene", value: "mine" }, { type: "scenes", scenes: [kScene] });
    expect(state.form.scene).toBe("mine");
  });

  test("typing into a field removes its error only", () => {
    const state = run({ type: "form_invalid", errors: { width: "no", height: "no" } },
      { type: "form", key: "width", value: "3" });
    expect(state.form_errors).toEqual({ height: "no" });
  });

  test("a refusal that stands at fields needs no second sentence", () => {
    const state = run({ type: "submit_started" }, { type: "submit_failed", problem, errors: { width: "too wide" } });
    expect([state.submitting, state.form_problem]).toEqual([false, ""]);
  });

  test("a refusal without a field is said at the button", () => {
    const busy = new Problem(429, "queue_full", "Busy", "64 jobs are waiting", "", [], 3);
    const state = run({ type: "submit_failed", problem: busy, errors: {} });
    expect(state.form_problem).toContain("64 jobs are waiting");
    expect(state.form_problem).toContain("3 s");
  });

  test("the reducer does not write into the state that it is given", () => {
    const before = start();
    const copy = structuredClone(before);
    reduce(before, { type: "job", job: job(), now_ms: 1 });
    reduce(before, { type: "form", key: "width", value: "1" });
    reduce(before, { type: "scenes", scenes: [kScene] });
    expect(before).toEqual(copy);
    expect(before.form).toBe(kDefaultForm);
  });
});

describe("batches", () => {
  const batch = (changes: object): Batch => ({
    id: "b_1", name: "", state: "running", revision: 3, created_at: "2026-01-01T00:00:00Z", finished_at: null, items: [],
    counts: { waiting: 1, active: 0, completed: 0, failed: 0, cancelled: 0, skipped: 0, reused: 0, total: 1 }, ...changes,
  });
  const on_page: Action = { type: "route", route: { page: "batch", id: "b_1" } };
  test("only news of the batch on the page counts, and no older one", () => {
    const newest = batch({});
    expect(run(on_page, { type: "batch", batch: newest }, { type: "batch", batch: batch({ revision: 2 }) },
      { type: "batch", batch: batch({ id: "b_2", revision: 9 }) }).batch).toBe(newest);
    expect(run({ type: "batch", batch: newest }).batch).toBeNull();
  });
  test("it is forgotten with its page", () => {
    expect(run(on_page, { type: "batch", batch: batch({}) }, { type: "route", route: { page: "batches" } }).batch).toBeNull();
  });
});
