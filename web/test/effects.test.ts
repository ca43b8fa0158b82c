import { expect, test } from "vitest";
import { in_order, reason, verdict } from "../src/view/effects";

const line = { effect: "point_lights", called_for: true, simulated: true, evidence: "a lamp", grade: "", left_out: "" };
const dropped = { ...line, effect: "fresnel", called_for: false, simulated: false, evidence: "no glass", grade: "identical", left_out: "Fresnel's equations" };
const draft = { ...line, effect: "caustics", simulated: false, evidence: "a mirror", grade: "bounded", left_out: "telling lobes apart" };

test("what is called for and left out comes first", () => {
  expect(in_order([dropped, line, draft]).map((one) => one.effect)).toEqual(["caustics", "point_lights", "fresnel"]);
});

test("each effect has a verdict and a reason", () => {
  expect([line, dropped, draft].map(verdict)).toEqual(["simulated", "left out", "left out on request"]);
  expect(verdict({ ...line, called_for: false })).toBe("simulated, though not called for");
  expect(reason(line)).toBe("a lamp");
  expect(reason(dropped)).toBe("no glass. Without Fresnel's equations; the picture is the same.");
  expect(reason(draft)).toBe("a mirror. Without telling lobes apart; bounded: the picture is another one.");
});
