import { describe, expect, test } from "vitest";
import type { JobAccuracy } from "../src/contract";
import { error_at, is_reached, kPriceSteps, seconds_left } from "../src/price";

const range = (value: number): { value: number; low: number; high: number } => ({ value, low: 0.8 * value, high: 1.25 * value });
/** error = 0.2 / sqrt(seconds), after 4 seconds. */
const accuracy: JobAccuracy = {
  points: [{ render_seconds: 4, samples: 64, error: { value: 0.1, low: 0.09, high: 0.11 } }],
  slope: null, seconds_to_halve_error: null, target: null, seconds_to_target: null, forecasts: [], tile_samples: null,
  prices: [0.1, 0.05, 0.02, 0.01, 0.005].map((error) =>
    ({ error, reached: error >= 0.1, seconds: range((0.2 / error) ** 2), seconds_left: null })),
};

describe("the price of less error", () => {
  test("is read between the prices on a line in the log-log plot", () => {
    for (const error of [0.1, 0.07, 0.05, 0.013, 0.005]) {
      const left = seconds_left(accuracy, error);
      const total = (0.2 / error) ** 2;
      expect(left?.value).toBeCloseTo(Math.max(0, total - 4), 6);
      expect(left?.high).toBeCloseTo(Math.max(0, 1.25 * total - 4), 6);
    }
  });

  test("is unknown outside and without prices", () => {
    expect(seconds_left(accuracy, 0.004)).toBeNull();
    expect(seconds_left(accuracy, 0.2)).toBeNull();
    expect(seconds_left({ ...accuracy, prices: accuracy.prices.map((p) => ({ ...p, seconds: null })) }, 0.02)).toBeNull();
  });

  test("the control goes from rough to exact and knows what is reached", () => {
    expect(error_at(0)).toBe(0.1);
    expect(error_at(kPriceSteps)).toBe(0.005);
    for (let i = 1; i <= kPriceSteps; i++) expect(error_at(i)).toBeLessThan(error_at(i - 1));
    expect(is_reached(accuracy, 0.2)).toBe(true);
    expect(is_reached(accuracy, 0.1)).toBe(false); // the interval reaches above
    expect(is_reached({ ...accuracy, points: [] }, 0.1)).toBe(false);
  });
});
