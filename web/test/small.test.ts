import { describe, expect, test } from "vitest";
import { announcement } from "../src/announce";
import { backoff_ms, kLongestDelayMs } from "../src/backoff";
import { shortcut } from "../src/keys";
import { explain, parse_problem, unreachable } from "../src/problem";
import { parse_route, route_path } from "../src/route";
import { layers_of } from "../src/contract";
import { legend } from "../src/view/layers";
import { warning_lines } from "../src/view/warnings";
import { job } from "./sample";

test.each([
  ["/", { page: "home" }], ["/jobs/", { page: "home" }], ["/jobs/j_1", { page: "job", id: "j_1" }], ["/jobs/j_1/", { page: "job", id: "j_1" }],
  ["/jobs/%zz", { page: "home" }],
  ["/batches", { page: "batches" }], ["/batches/", { page: "batches" }], ["/batches/b_1", { page: "batch", id: "b_1" }], ["/elsewhere", { page: "home" }],
])("route %s", (path, route) => expect(parse_route(path)).toEqual(route));

test("a route's path leads back to it", () => {
  for (const route of [{ page: "job", id: "a b/c" }, { page: "batch", id: "a b/c" }, { page: "batches" }] as const) {
    expect(parse_route(route_path(route))).toEqual(route);
  }
});

describe("problem", () => {
  test("reads a problem document", () => {
    const problem = parse_problem(422, JSON.stringify({
      title: "Unprocessable Content", code: "invalid_request", detail: "2 fields are wrong",
      errors: [{ pointer: "/width", code: "out_of_range", detail: "must be 1 to 16384" }, { nonsense: 1 }, null],
    }), null);
    expect(problem.code).toBe("invalid_request");
    expect(problem.fields).toEqual([{ pointer: "/width", message: "must be 1 to 16384" }]);
  });

  test.each([["<html>proxy</html>"], [""], ["[]"], ["null"], ["{\"errors\":7}"]])("survives %j", (body) => {
    const problem = parse_problem(502, body, "soon");
    expect([problem.status, problem.code, problem.retry_after]).toEqual([502, "http_502", null]);
    expect(explain(problem)).toBe("The server failed.");
  });

  test("says where, what to do, and when to try again", () => {
    const text = explain(parse_problem(422, "{\"code\":\"scene_invalid\",\"detail\":\"Kd needs three numbers\",\"where\":\"box.mtl:7\"}", null));
    expect(text).toBe("box.mtl:7: Kd needs three numbers. Correct the file and upload the scene again.");
    expect(explain(parse_problem(429, "{\"code\":\"queue_full\",\"detail\":\"full\"}", "2"))).toContain("Try again in 2 s.");
    expect(explain(unreachable())).toContain("raykilnd");
  });
});

describe("announcement", () => {
  const at = (fraction: number, changes = {}) => job({ progress: { ...job().progress, fraction }, ...changes });
  test("is silent between quarters", () => expect(announcement(at(0.26), at(0.49))).toBe(""));
  test("speaks at a quarter, with the time left", () => expect(announcement(at(0.49), at(0.51))).toBe("50 % rendered, 6.0 s left"));
  test("speaks at a change of state", () => {
    expect(announcement(at(0.9), at(1, { state: "completed", elapsed_seconds: 8 }))).toBe("Render completed in 8.0 s");
    expect(announcement(at(0.9), at(0.9, { state: "failed", error: { title: "t", status: 500, detail: "no memory", code: "c" } })))
      .toBe("Render failed: no memory");
  });
  test("says the state of a job that is opened late", () => expect(announcement(undefined, at(1, { state: "cancelled" }))).toBe("Render cancelled"));
});

test("backoff grows to its ceiling and no further", () => {
  const delays = Array.from({ length: 40 }, (_, attempt) => backoff_ms(attempt, 0.999));
  expect(delays[0]).toBeLessThanOrEqual(500);
  expect(delays.every((delay, index) => index === 0 || delay >= (delays[index - 1] ?? 0))).toBe(true);
  expect(Math.max(...delays)).toBeLessThanOrEqual(kLongestDelayMs);
  expect(backoff_ms(0, 0)).toBeGreaterThan(0);
});

describe("shortcut", () => {
  const press = (key: string, more = {}) => ({ key, ctrlKey: false, metaKey: false, altKey: false, ...more });
  test("works on its page only", () => {
    expect(shortcut(press("f"), true, false)).toBe("fit");
    expect(shortcut(press("f"), false, false)).toBeNull();
    expect(shortcut(press("?"), false, false)).toBe("help");
  });
  test("leaves typing and the browser's own keys alone", () => {
    expect(shortcut(press("h"), true, true)).toBeNull();
    expect(shortcut(press("r", { ctrlKey: true }), true, false)).toBeNull();
    expect(shortcut(press("c"), true, false)).toBeNull(); // cancel needs Shift
    expect(shortcut(press("C"), true, false)).toBe("cancel");
  });
});

test("equal warnings are counted, many are cut", () => {
  const warn = (message: string, where = "", count?: number) => ({ code: "c", message, where, ...(count ? { count } : {}) });
  expect(warning_lines([warn("a", "x:1"), warn("a", "x:9"), warn("b", "", 4)])).toEqual(["a (x:1 and elsewhere) × 2", "b × 4"]);
  expect(warning_lines(Array.from({ length: 20 }, (_, index) => warn(`w${index}`))).length).toBe(7);
});

test("the stage offers what a job has, and says what it shows", () => {
  const request = job().request;
  expect(layers_of(request)).toEqual(["beauty", "error", "samples", "seconds"]);
  expect(layers_of({ ...request, layers: ["direct", "depth", "new"] })).toEqual(["beauty", "error", "samples", "seconds", "depth", "direct"]);
  expect(legend("depth", { low: 0, high: 20, scale: "linear" })).toBe("0 to 20 m");
  expect(legend("error", { low: 0.001, high: 1, scale: "log" })).toBe("0.001 to 1 radiance, logarithmic");
  expect(legend("beauty", null)).toBe("");
  expect(legend("normal", null)).not.toBe("");
});
