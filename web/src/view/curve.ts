// The plot of error against time on the job page.

import type { JobAccuracy } from "../contract";
import { duration, error_percent } from "../format";
import { kPlot, plot_of, type Axis, type Plot } from "../plot";
import { Facts, h, set_hidden } from "./dom";

const kSvg = "http://www.w3.org/2000/svg";

function s(tag: string, attributes: Record<string, string | number>, text = ""): SVGElement {
  const element = document.createElementNS(kSvg, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  if (text) element.textContent = text;
  return element;
}

export class CurveView {
  private svg_ = s("svg", { viewBox: `0 0 ${kPlot.width} ${kPlot.height}`, role: "img" });
  private facts_ = new Facts();
  readonly element = h("details", { open: true, hidden: true, class: "curve" },
    h("summary", {}, "Error against time"), this.svg_, this.facts_.element);
  private shown_: JobAccuracy | null = null;

  update(accuracy: JobAccuracy | null): void {
    if (accuracy === this.shown_) return;
    this.shown_ = accuracy;
    const plot = accuracy ? plot_of(accuracy) : null;
    set_hidden(this.element, plot === null);
    if (!accuracy || !plot) return;
    this.draw(accuracy, plot);
    this.facts_.update(rows(accuracy));
  }

  private draw(accuracy: JobAccuracy, plot: Plot): void {
    const label = `Error over render seconds, ${accuracy.points.length} points, from ` +
      `${error_percent(accuracy.points[0]?.error?.value ?? 0)} to ${error_percent(accuracy.points.at(-1)?.error?.value ?? 0)}`;
    this.svg_.setAttribute("aria-label", label);
    const curves: [string, string][] = [["band", plot.band], ["guide", plot.guide], ["target", plot.target],
      ["forecast", plot.forecast], ["line", plot.line]];
    this.svg_.replaceChildren(
      ...ticks(plot.x, true), ...ticks(plot.y, false),
      ...curves.filter(([, d]) => d !== "").map(([name, d]) => s("path", { class: name, d })));
  }
}

function ticks(axis: Axis, along: boolean): SVGElement[] {
  const { left, right, top, bottom, width, height } = kPlot;
  return axis.ticks.flatMap((value) => {
    const at = axis.at(value);
    return along
      ? [s("line", { class: "grid", x1: at, x2: at, y1: top, y2: height - bottom }),
        s("text", { x: at, y: height - bottom + 16, "text-anchor": "middle" }, `${value} s`)]
      : [s("line", { class: "grid", x1: left, x2: width - right, y1: at, y2: at }),
        s("text", { x: left - 6, y: at + 4, "text-anchor": "end" }, error_percent(value))];
  });
}

function rows(accuracy: JobAccuracy): [string, string][] {
  const list: [string, string][] = [];
  const { slope, seconds_to_halve_error: half, seconds_to_target: target } = accuracy;
  if (slope) list.push(["Slope", `${slope.value.toFixed(2)} ± ${slope.standard_error.toFixed(2)} (independent samples: −0.50)`]);
  if (half) list.push(["Half the error", `${duration(half.low)} to ${duration(half.high)} more`]);
  if (target && target.high > 0) list.push(["To the target", `${duration(target.low)} to ${duration(target.high)} more`]);
  const scored = accuracy.forecasts.filter((one) => one.hit !== null);
  if (scored.length > 0) list.push(["Forecasts held", `${scored.filter((one) => one.hit).length} of ${scored.length}`]);
  return list;
}
