// Error against time on logarithmic axes, as numbers and SVG paths. No DOM here.

import type { JobAccuracy } from "./contract";

export const kPlot = { width: 360, height: 220, left: 48, right: 10, top: 10, bottom: 30 };

export interface Axis {
  low: number;
  high: number;
  /** Value to position. */
  at(value: number): number;
  ticks: number[];
}

/** Values 1, 2, 5 times powers of ten inside the range; the powers alone where there would be many. */
function ticks_of(low: number, high: number): number[] {
  const with_steps = (steps: readonly number[]): number[] => {
    const all: number[] = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
      for (const step of steps) all.push(Number((step * 10 ** power).toPrecision(3)));
    }
    return all.filter((value) => value >= low * 0.999 && value <= high * 1.001);
  };
  const fine = with_steps([1, 2, 5]);
  return fine.length <= 7 ? fine : with_steps([1]);
}

export function log_axis(values: readonly number[], from: number, to: number): Axis {
  const usable = values.filter((value) => value > 0 && Number.isFinite(value));
  let low = usable.length > 0 ? Math.min(...usable) : 0.1;
  let high = usable.length > 0 ? Math.max(...usable) : 1;
  if (high / low < 1.5) [low, high] = [low / 1.25, high * 1.25];
  const span = Math.log(high / low);
  const at = (value: number): number => from + ((to - from) * Math.log(Math.max(value, low * 1e-3) / low)) / span;
  return { low, high, at, ticks: ticks_of(low, high) };
}

export interface Plot {
  x: Axis;
  y: Axis;
  line: string;
  band: string;
  /** Slope -1/2 through the last point. */
  guide: string;
  /** The target error from side to side; empty without one. */
  target: string;
  /** When the error will be half of what it is: a range at that error. */
  forecast: string;
}

const round = (value: number): string => value.toFixed(1);
const path = (points: readonly (readonly [number, number])[]): string =>
  points.map(([x, y], i) => `${i === 0 ? "M" : "L"}${round(x)} ${round(y)}`).join("");

/** Null below two points: there is no line to show. */
export function plot_of(accuracy: JobAccuracy): Plot | null {
  const points = accuracy.points.filter((point) => point.error !== null && point.error.value > 0 && point.render_seconds > 0);
  const last = points[points.length - 1];
  if (points.length < 2 || !last?.error) return null;
  const half = accuracy.seconds_to_halve_error;
  const now = last.render_seconds;
  const then = half ? [now + half.low, now + half.high] : [];
  const { left, right, top, bottom, width, height } = kPlot;
  const target = accuracy.target !== null && accuracy.target > 0 ? [accuracy.target] : [];
  const x = log_axis([...points.map((point) => point.render_seconds), ...then], left, width - right);
  const y = log_axis([
    ...points.flatMap((point) => [point.error?.low ?? 0, point.error?.high ?? 0]), ...target, last.error.value / 2,
  ], height - bottom, top);
  const on = (seconds: number, error: number): [number, number] => [x.at(seconds), y.at(error)];
  const highs = points.map((point) => on(point.render_seconds, point.error?.high ?? 0));
  const lows = points.map((point) => on(point.render_seconds, point.error?.low ?? 0));
  const error = last.error.value;
  const guide = (seconds: number): number => error * Math.sqrt(now / seconds);
  return {
    x, y,
    line: path(points.map((point) => on(point.render_seconds, point.error?.value ?? 0))),
    band: `${path([...highs, ...lows.reverse()])}Z`,
    guide: path([on(x.low, guide(x.low)), on(x.high, guide(x.high))]),
    target: target.map((value) => path([[left, y.at(value)], [width - right, y.at(value)]])).join(""),
    forecast: half ? path([on(now + half.low, error / 2), on(now + half.high, error / 2)]) : "",
  };
}
