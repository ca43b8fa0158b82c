import { describe, expect, test } from "vitest";
import { check_form, from_job, kDefaultForm, kOwnCamera, place_errors, to_request, toggled, type FormValues } from "../src/form";
import { job, kScene } from "./sample";

const filled = (changes: Partial<FormValues> = {}): FormValues => ({ ...kDefaultForm, scene: kScene.id, ...changes });

describe("check_form", () => {
  test("the defaults need a scene and nothing else", () => {
    expect(Object.keys(check_form(kDefaultForm))).toEqual(["scene"]);
    expect(check_form(filled())).toEqual({});
  });

  test.each([
    ["width", "0"], ["width", "16385"], ["width", "12.5"], ["width", ""], ["samples", "1e3"], ["max_depth", "1025"], ["seed", "-1"],
    ["seed", "9007199254740993"], ["priority", "0"], ["priority", "101"], ["branches", "x"],
  ] as const)("%s refuses %j", (key, value) => expect(Object.keys(check_form(filled({ [key]: value })))).toEqual([key]));

  test("an own camera is checked only when it is chosen", () => {
    expect(check_form(filled({ eye: "1 2" }))).toEqual({});
    expect(Object.keys(check_form(filled({ camera: kOwnCamera, eye: "1 2", fov_deg: "wide" })))).toEqual(["eye", "fov_deg"]);
  });
});

describe("to_request and from_job", () => {
  test("what was asked for fills the form again", () => {
    const values = filled({ camera: "1", width: "100", seed: "7", emitter_sampling: "false", sampler: "sobol", name: "x", priority: "3" });
    expect(from_job(job({ request: to_request(values) }), [])).toEqual(values);
  });

  test("the light model and its overrides survive the round", () => {
    const values = filled({ light_model: "seed", fresnel: "exact", radiance_scaling: "true", roulette: "false" });
    const request = to_request(values);
    expect(request.light_model_overrides).toEqual({ fresnel: "exact", radiance_scaling: true, roulette: false });
    expect(from_job(job({ request }), [])).toEqual(values);
    expect(to_request(filled()).light_model_overrides).toEqual({});
  });

  test("what is left out survives the round, and is sent only where it is asked for", () => {
    const values = filled({ effects: "without", without: "refraction,caustics" });
    const request = to_request(values);
    expect(request.effects).toEqual({ without: ["refraction", "caustics"] });
    expect(from_job(job({ request }), [])).toEqual(values);
    expect(to_request(filled({ without: "refraction" })).effects).toBe("auto");
    expect(from_job(job({ request: to_request(filled({ effects: "all" })) }), []).effects).toBe("all");
    expect(check_form(filled({ effects: "without" }))).toEqual({ without: "Choose at least one effect." });
    expect(toggled("a,b", "a", false)).toBe("b");
    expect(toggled("b", "a", true)).toBe("b,a");
  });

  test("an own camera survives the round", () => {
    const values = filled({ camera: kOwnCamera, eye: "1, 2;  3.5", look_at: "0 0 -1", fov_deg: "55" });
    const request = to_request(values);
    expect(request.camera).toEqual({ eye: [1, 2, 3.5], look_at: [0, 0, -1], up: [0, 1, 0], fov_deg: 55 });
    expect(from_job(job({ request }), [])).toEqual({ ...values, eye: "1 2 3.5" });
  });

  test("a tree's budget survives the round, and is left out where it is empty", () => {
    const values = filled({ tree_references: "1.5", tree_bytes: "500000000" });
    const request = to_request(values);
    expect(request.tree).toEqual({ references_per_triangle: 1.5, max_bytes: 500000000 });
    expect(from_job(job({ request }), [])).toMatchObject({ tree_references: "1.5", tree_bytes: "500000000" });
    expect(Object.keys(to_request(filled()))).not.toContain("tree");
    expect(to_request(filled({ tree_references: "2" })).tree).toEqual({ references_per_triangle: 2 });
    expect(from_job(job({ request: { ...request, tree: { references_per_triangle: 4 } } }), [])).toMatchObject({ tree_references: "", tree_bytes: "" });
    expect(Object.keys(check_form(filled({ tree_references: "0.5", tree_bytes: "0" })))).toEqual(["tree_references", "tree_bytes"]);
    expect(place_errors([{ pointer: "/tree/max_bytes", message: "more" }])).toEqual({ tree_bytes: "more" });
  });

  test("lens, window, view height and layers survive the round", () => {
    const values = filled({
      camera: kOwnCamera, view_height: "2.5", lens: "0.05 2", crop: "640 0 1920 1080", layers: "albedo,depth,direct",
    });
    const request = to_request(values);
    expect(request.camera).toEqual({ eye: [0, 0, 5], look_at: [0, 0, 0], up: [0, 1, 0], view_height: 2.5 });
    expect(request.lens).toEqual({ radius: 0.05, focus_distance: 2 });
    expect(request.crop).toEqual({ x: 640, y: 0, full_width: 1920, full_height: 1080 });
    expect(request.layers).toEqual(["albedo", "depth", "direct"]);
    expect(from_job(job({ request }), [])).toEqual(values);
    expect(Object.keys(to_request(filled()))).not.toContain("lens");
    expect(check_form(filled({ lens: "0.1" }))).toEqual({ lens: "Enter two numbers, for example 0.05 2." });
    expect(Object.keys(check_form(filled({ crop: "1 2 3", camera: kOwnCamera, view_height: "0" })))).toEqual(["view_height", "crop"]);
    expect(place_errors([{ pointer: "/crop/x", message: "leaves" }, { pointer: "/layers/0", message: "none" }]))
      .toEqual({ crop: "leaves", layers: "none" });
  });

  test("stops by error and time survive the round, typed in percent", () => {
    const values = filled({ samples: "", error: "2.5", seconds: "60" });
    const request = to_request(values);
    expect(request.stop).toEqual({ error: 0.025, seconds: 60 });
    expect(from_job(job({ request: { ...request, stop: { ...request.stop, samples: 1048576 } } }), [])).toEqual(values);
    expect(to_request(filled()).stop).toEqual({ samples: 64 });
  });

  test("one of the stops is needed", () => {
    expect(Object.keys(check_form(filled({ samples: "" })))).toEqual(["samples"]);
    expect(check_form(filled({ samples: "", error: "2" }))).toEqual({});
    expect(Object.keys(check_form(filled({ error: "0" })))).toEqual(["error"]);
  });

  test("a camera by name becomes its index", () => {
    const request = { ...to_request(filled()), camera: "top" };
    expect(from_job(job({ request }), kScene.cameras).camera).toBe("1");
  });
});

test("errors stand at the nearest field", () => {
  expect(place_errors([
    { pointer: "/width", message: "a" }, { pointer: "/stop/sample", message: "b" }, { pointer: "/camera/eye/0", message: "c" },
    { pointer: "/camera", message: "d" }, { pointer: "/light_model_overrides/fresnel", message: "f" },
    { pointer: "/effects/without/1", message: "g" }, { pointer: "/unknown", message: "e" }, { pointer: "/width", message: "second" },
  ])).toEqual({ width: "a", samples: "b", eye: "c", camera: "d", fresnel: "f", without: "g" });
});
