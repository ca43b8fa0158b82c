import { describe, expect, test } from "vitest";
import * as format from "../src/format";

const thin = (text: string) => text.replaceAll("\u2009", " ");

describe("format", () => {
  test.each([
    [0, "0.0 s"], [0.44, "0.4 s"], [9.94, "9.9 s"], [9.96, "10 s"], [59.4, "59 s"], [59.6, "1 min 00 s"], [185, "3 min 05 s"],
    [3599.6, "1 h 00 min"], [7620, "2 h 07 min"], [null, "–"], [Number.NaN, "–"], [-1, "–"],
  ])("duration %s", (value, text) => expect(format.duration(value)).toBe(text));

  test.each([[0, "0"], [999, "999"], [1000, "1 000"], [1234567, "1 234 567"], [undefined, "–"]])(
    "count %s", (value, text) => expect(thin(format.count(value))).toBe(text));

  test.each([[0, "0"], [950, "950"], [1500, "1.50 k"], [999_900, "1.00 M"], [6_553_600, "6.55 M"], [43_400_000_000, "43.4 G"]])(
    "si %s", (value, text) => expect(format.si(value)).toBe(text));

  test.each([[6_553_600, "6.55 Mrays/s"], [120, "120 rays/s"], [null, "–"]])(
    "ray_rate %s", (value, text) => expect(format.ray_rate(value)).toBe(text));

  test.each([[0, "0 B"], [1023, "1023 B"], [1024, "1.00 KiB"], [90112000, "85.9 MiB"], [null, "–"]])(
    "bytes %s", (value, text) => expect(format.bytes(value)).toBe(text));

  test.each([[0, "0 %"], [0.256, "25 %"], [0.9999, "99 %"], [1, "100 %"], [null, "–"]])(
    "percent %s is done only at the end", (value, text) => expect(format.percent(value)).toBe(text));

  test.each([[0, "±0.0 EV"], [1.5, "+1.5 EV"], [-2, "−2.0 EV"]])(
    "stops %s", (value, text) => expect(format.stops(value)).toBe(text));

  test.each([
    ["2026-01-01T00:00:00Z", 10, "just now"], ["2026-01-01T00:00:00Z", 300, "5 min ago"], ["2026-01-01T00:00:00Z", 7200, "2 h ago"],
    ["2026-01-01T00:00:00Z", 90000, "yesterday"], ["2026-01-01T00:00:00Z", 260000, "3 days ago"], ["never", 0, "–"], [null, 0, "–"],
  ])("ago %s + %s s", (iso, seconds, text) =>
    expect(format.ago(iso, Date.parse("2026-01-01T00:00:00Z") + seconds * 1000)).toBe(text));

  test.each([
    ["merge_seconds", 0.021, "21.0 ms"], ["render_seconds", 75, "1 min 15 s"], ["film_bytes", 2048, "2.00 KiB"], ["overhead_fraction", 0.0113, "1.13 %"],
    ["rays_per_second", 2e6, "2.00 Mrays/s"], ["tasks", 118, "118"], ["sah_cost", 24.8123, "24.81"], ["budget_reached", false, "no"],
    ["tree_build_seconds", null, "–"],
  ])("statistic %s", (key, value, text) => expect(format.statistic(key, value)).toBe(text));

  test("labels drop the unit that the value shows", () => {
    expect(format.label_of("non_finite_samples")).toBe("Non-finite samples");
    expect(format.label_of("merge_seconds")).toBe("Merge time");
    expect(format.label_of("overhead_fraction")).toBe("Overhead");
  });
});
