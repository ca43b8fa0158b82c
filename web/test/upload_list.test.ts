import { describe, expect, test } from "vitest";
import { plan_uploads, scene_name, strip_common_folder } from "../src/upload_list";

const files = (...paths: string[]) => paths.map((path) => ({ path, file: new Blob(["12345"]) }));
const shape = (...paths: string[]) =>
  plan_uploads(files(...paths)).map((plan) => [plan.kind, plan.label, plan.files.map((one) => one.path)]);

describe("plan_uploads", () => {
  test("a zip and a glb are scenes of their own", () => {
    expect(shape("a.zip", "b.GLB")).toEqual([["raw", "a.zip", ["a.zip"]], ["raw", "b.GLB", ["b.GLB"]]]);
    expect(plan_uploads(files("b.GLB"))[0]?.media_type).toBe("model/gltf-binary");
  });

  test("loose files make one scene, named after its root file", () => {
    expect(shape("box.mtl", "box.obj")).toEqual([["multipart", "box.obj", ["box.mtl", "box.obj"]]]);
    expect(plan_uploads(files("box.mtl", "box.obj"))[0]).toMatchObject({ name: "box", total_bytes: 10 });
  });

  test("a lone obj is a multipart of one", () => expect(shape("box.obj")).toEqual([["multipart", "box.obj", ["box.obj"]]]));

  test("a dropped folder's own name goes, inner folders stay", () => {
    expect(shape("spider/spider.obj", "spider/textures/wood.png"))
      .toEqual([["multipart", "spider.obj", ["spider.obj", "textures/wood.png"]]]);
  });

  test("what systems leave behind is not sent", () => {
    expect(shape("s/.DS_Store", "s/__MACOSX/x", "s/Thumbs.db", "s/a.obj")).toEqual([["multipart", "a.obj", ["a.obj"]]]);
    expect(shape(".DS_Store")).toEqual([]);
  });

  test("a glb with a sidecar goes together with it", () => {
    expect(shape("m.glb", "raykiln.json")).toEqual([["multipart", "m.glb", ["m.glb", "raykiln.json"]]]);
  });

  test("backslashes become slashes", () => expect(shape("d\\a.obj", "d\\t\\b.png")[0]?.[2]).toEqual(["a.obj", "t/b.png"]));
});

test("strip_common_folder leaves a file its name", () => {
  expect(strip_common_folder(["a/b/c.obj"])).toEqual(["c.obj"]);
  expect(strip_common_folder(["a/x", "b/y"])).toEqual(["a/x", "b/y"]);
  expect(strip_common_folder([])).toEqual([]);
});

test("scene_name stays within the contract", () => {
  expect(scene_name("spider.obj")).toBe("spider");
  expect(scene_name("a\u0007b.zip")).toBe("a b");
  expect(new TextEncoder().encode(scene_name("ü".repeat(300))).length).toBeLessThanOrEqual(200);
});
