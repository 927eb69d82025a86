// SPDX-License-Identifier: Apache-2.0
// uPlot with the page's colours: two axes with units, one line, and whatever is drawn over it.
/* global uPlot */
import { short } from "./format.js";
import { colour } from "./page.js";

const axis = (label, size) => ({
  label, size, labelSize: 18, labelFont: "12px system-ui, sans-serif", font: "12px system-ui, sans-serif",
  stroke: () => colour("soft"), grid: { stroke: () => colour("line"), width: 1 },
  ticks: { stroke: () => colour("line"), width: 1 }, values: (_, splits) => splits.map((v) => short(v)),
});

/**
 * plot: {box, x, y: labels, dash?, draw(u)}. ranges: {x: [low, high], y: [low, high]} as a function,
 * asked at each change. Drag to look nearer, double click to see all.
 */
export class Plot {
  constructor({ box, x, y, dash, ranges, draw }) {
    this.box = box;
    this.options = {
      width: 10, height: 10, legend: { show: false }, cursor: { points: { show: false }, y: false },
      scales: {
        x: { time: false, range: (_, low, high) => (this.isNear ? [low, high] : ranges().x) },
        y: { range: () => ranges().y },
      },
      series: [{}, { stroke: () => colour("accent"), width: 2, dash, points: { show: false } }],
      axes: [axis(x, 42), axis(y, 62)],
      hooks: { draw: [draw], setSelect: [(u) => { this.isNear = u.select.width > 0; }] },
    };
    box.addEventListener("dblclick", () => { this.isNear = false; });
  }

  /** line: pairs of x and y, in rising order. */
  show(line) {
    if (this.box.clientWidth === 0) return;
    const data = [line.map((p) => p[0]), line.map((p) => p[1])];
    if (data[0].length === 0) for (const values of data) values.push(null);
    if (!this.chart) this.chart = new uPlot(this.options, data, this.box);
    const { clientWidth: width, clientHeight: height } = this.box;
    if (this.chart.width !== width || this.chart.height !== height) this.chart.setSize({ width, height });
    this.chart.setData(data, true);
  }

  label(x, y) {
    this.options.axes[0].label = x;
    this.options.axes[1].label = y;
    if (!this.chart) return;
    this.chart.axes[0].label = x;
    this.chart.axes[1].label = y;
  }
}

/** Ends of some values, with room at both sides; `otherwise` where there are none. */
export function ends(values, otherwise, room = 0.04) {
  const known = values.filter(Number.isFinite);
  if (!known.length) return otherwise;
  const low = Math.min(...known), high = Math.max(...known);
  const more = (high - low || Math.abs(high) || 1) * room;
  return [low - more, high + more];
}

/** Where values of the plot lie on its canvas. */
export const placeOn = (u, x, y) => [u.valToPos(x, "x", true), u.valToPos(y, "y", true)];

/** Draws within the axes only. */
export function inside(u, draw) {
  const { ctx: context, bbox } = u;
  context.save();
  context.beginPath();
  context.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  context.clip();
  draw(context, bbox, devicePixelRatio || 1);
  context.restore();
}
