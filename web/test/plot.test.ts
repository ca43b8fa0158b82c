import { describe, expect, test } from "vitest";
import type { JobAccuracy } from "../src/contract";
import { kPlot, log_axis, plot_of } from "../src/plot";

const curve = (points: [number, number][], changes: Partial<JobAccuracy> = {}): JobAccuracy => ({
  points: points.map(([render_seconds, value]) =>
    ({ render_seconds, samples: 1, error: { value, low: 0.9 * value, high: 1.1 * value } })),
  slope: null, seconds_to_halve_error: null, target: null, seconds_to_target: null, prices: [], forecasts: [], tile_samples: null,
  ...changes,
});
const numbers = (path: string): number[] => (path.match(/-?\d+(\.\d+)?/g) ?? []).map(Number);

describe("log_axis", () => {
  test("equal ratios are equal distances", () => {
    const axis = log_axis([1, 100], 0, 200);
    expect(axis.at(1)).toBeCloseTo(0);
    expect(axis.at(10)).toBeCloseTo(100);
    expect(axis.at(100)).toBeCloseTo(200);
  });

  test("ticks are few, inside and in order", () => {
    for (const range of [[0.013, 0.9], [1, 1e6], [0.3, 0.31], [1e-4, 1]] as const) {
      const { ticks, low, high } = log_axis([...range], 0, 1);
      expect(ticks.length).toBeLessThanOrEqual(8);
      for (const tick of ticks) expect(tick >= low * 0.99 && tick <= high * 1.01).toBe(true);
      expect([...ticks].sort((a, b) => a - b)).toEqual(ticks);
    }
    expect(log_axis([0.01, 1], 0, 1).ticks).toContain(0.1);
  });

  test("nothing, zeros and infinities make an axis all the same", () => {
    for (const values of [[], [0], [Infinity, -1]]) expect(Number.isFinite(log_axis(values, 0, 1).at(0))).toBe(true);
  });
});

describe("plot_of", () => {
  test("needs two points", () => {
    expect(plot_of(curve([]))).toBeNull();
    expect(plot_of(curve([[1, 0.1]]))).toBeNull();
    expect(plot_of(curve([[1, 0], [2, 0]]))).toBeNull();
  });

  test("the line of independent samples lies on the guide", () => {
    const plot = plot_of(curve([[1, 0.4], [4, 0.2], [16, 0.1]]));
    const line = numbers(plot?.line ?? ""), guide = numbers(plot?.guide ?? "");
    expect(guide.slice(0, 2)).toEqual(line.slice(0, 2));
    expect(guide.slice(2)).toEqual(line.slice(4));
  });

  test("target and forecast appear when there are some, inside the frame", () => {
    const plain = plot_of(curve([[1, 0.4], [4, 0.2]]));
    expect([plain?.target, plain?.forecast]).toEqual(["", ""]);
    const plot = plot_of(curve([[1, 0.4], [4, 0.2]],
      { target: 0.05, seconds_to_halve_error: { value: 12, low: 10, high: 15 } }));
    const [x0 = 0, , x1 = 0] = numbers(plot?.forecast ?? "");
    expect(x1).toBeGreaterThan(x0);
    expect(x1).toBeLessThanOrEqual(kPlot.width);
    expect(numbers(plot?.target ?? "")[1]).toBeCloseTo(kPlot.height - kPlot.bottom, 0);
  });
});
