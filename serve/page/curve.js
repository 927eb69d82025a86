// SPDX-License-Identifier: Apache-2.0
// The focus curve: points in the order in which they were measured, the fit, the answer with its
// sigma, second lobes; or the curves of runs that are compared.
import { isFound, secondLobes } from "./answer.js";
import { fixed, decimalsFor, short, withSigma } from "./format.js";
import { byId, colour, make, say, table } from "./page.js";
import { ends, inside, placeOn, Plot } from "./plot.js";
import { model, on, onTick, tell } from "./store.js";

const kMostNumbered = 40;
/** Of what is looked at near the answer: half widths of the points' scores above half height. */
const kNearSigmas = 30;
const kDashes = [[], [8, 5], [2, 4], [10, 4, 2, 4]];
const kColours = ["accent", "second", "soft", "ink"];

let plot = null;

/** What is drawn: the measurement, or runs that were opened ({name, points, result, unit}). */
function curves() {
  if (model.opened) return model.opened;
  const measurement = model.state?.measurement;
  if (!measurement) return [];
  const { points, result, scatter, kind } = measurement;
  return [{ name: kind, points, result, scatter, unit: model.state.lens?.unit ?? "" }];
}

/** Scores of several metrics cannot share an axis: then each is shown as a part of its best. */
function isRelative(all) {
  return all.length > 1 && new Set(all.map((c) => c.metric)).size > 1;
}

function scaled(all) {
  if (!isRelative(all)) return all;
  return all.map((curve) => {
    const most = Math.max(...curve.points.map((p) => p.score)) || 1;
    return { ...curve, points: curve.points.map((p) => ({ ...p, score: p.score / most })) };
  });
}

/** The answer and the points about its peak: where the score is above half way to the best. */
function near({ points, result }) {
  const best = Math.max(...points.map((p) => p.score)), floor = Math.min(...points.map((p) => p.score));
  const high = points.filter((p) => p.score > (best + floor) / 2).map((p) => p.position);
  const reach = Math.max(...high.map((p) => Math.abs(p - result.position)), kNearSigmas * (result.sigma ?? 0));
  return [result.position - 2 * reach, result.position + 2 * reach];
}

function xRange(all) {
  const { lens } = model.state ?? {};
  const whole = lens ? [lens.min, lens.max] : [0, 1];
  const first = all[0];
  if (model.isNear && isFound(first?.result)) return near(first);
  return ends(all.flatMap((c) => c.points.map((p) => p.position)), whole);
}

function yRange(all) {
  const scores = all.flatMap((c) => c.points.map((p) => p.score * (1 + 2 * (c.scatter ?? 0))));
  const fits = all.flatMap((c) => (isFound(c.result) ? c.result.fit ?? [] : []).map((p) => p[1]));
  const [, high] = ends([0, ...scores, ...(all.length === 1 ? fits : [])], [0, 1], 0.12);
  return [0, high];
}

function drawAnswer(context, u, { top, height }, { position, sigma }) {
  const [x] = placeOn(u, position, 0);
  const [left] = placeOn(u, position - (sigma ?? 0), 0), [right] = placeOn(u, position + (sigma ?? 0), 0);
  context.fillStyle = colour("band");
  context.fillRect(left, top, Math.max(right - left, 1), height);
  context.strokeStyle = colour("accent");
  stroke(context, [[x, top], [x, top + height]]);
}

function drawLobes(context, u, { top, height }, result, scale) {
  context.setLineDash([3 * scale, 4 * scale]);
  context.strokeStyle = context.fillStyle = colour("second");
  context.font = `${11 * scale}px system-ui, sans-serif`;
  context.textAlign = "left";
  secondLobes(result).forEach(({ position }) => {
    const [x] = placeOn(u, position, 0);
    stroke(context, [[x, top], [x, top + height]]);
    context.fillText("second lobe", x + 4 * scale, top + 12 * scale);
  });
  context.setLineDash([]);
}

function stroke(context, places) {
  context.beginPath();
  for (const [x, y] of places) context.lineTo(x, y);
  context.stroke();
}

/** The way that a search took, then every point with its scatter and its number. */
function drawPoints(context, u, { points, scatter }, scale) {
  const places = points.map((p) => placeOn(u, p.position, p.score));
  context.strokeStyle = colour("soft");
  context.globalAlpha = 0.35;
  stroke(context, places);
  context.globalAlpha = 1;
  context.font = `${10.5 * scale}px system-ui, sans-serif`;
  context.textAlign = "center";
  points.forEach((point, i) => {
    const [x, y] = places[i], isLast = i === points.length - 1;
    if (scatter) drawScatter(context, u, point, scatter);
    context.fillStyle = colour(isLast ? "second" : "accent");
    context.beginPath();
    context.arc(x, y, (isLast ? 5 : 3.5) * scale, 0, 2 * Math.PI);
    context.fill();
  });
  numberPoints(context, places, scale);
}

/** Numbers, but none over another: of a crowd the last to come keeps its number. */
function numberPoints(context, places, scale) {
  if (places.length > kMostNumbered) return;
  const kept = [];
  context.fillStyle = colour("soft");
  for (let i = places.length - 1; i >= 0; --i) {
    const [x, y] = places[i];
    if (kept.some(([a, b]) => Math.abs(a - x) < 15 * scale && Math.abs(b - y) < 13 * scale)) continue;
    kept.push(places[i]);
    context.fillText(String(i + 1), x, y - 8 * scale);
  }
}

function drawScatter(context, u, { position, score }, scatter) {
  context.strokeStyle = colour("accent");
  stroke(context, [placeOn(u, position, score * (1 - scatter)), placeOn(u, position, score * (1 + scatter))]);
}

function drawCompared(context, u, curve, i, scale) {
  const sorted = [...curve.points].sort((a, b) => a.position - b.position);
  context.strokeStyle = context.fillStyle = colour(kColours[i % kColours.length]);
  context.setLineDash(kDashes[i % kDashes.length].map((d) => d * scale));
  context.lineWidth = 1.75 * scale;
  const places = sorted.map((p) => placeOn(u, p.position, p.score));
  stroke(context, places);
  context.setLineDash([]);
  for (const [x, y] of places) context.fillRect(x - 2 * scale, y - 2 * scale, 4 * scale, 4 * scale);
}

function drawAll(u) {
  const all = scaled(curves());
  inside(u, (context, box, scale) => {
    context.lineWidth = 1.25 * scale;
    if (all.length > 1) return all.forEach((curve, i) => drawCompared(context, u, curve, i, scale));
    const [only] = all;
    if (!only) return;
    if (isFound(only.result)) {
      drawAnswer(context, u, box, only.result);
      drawLobes(context, u, box, only.result, scale);
    }
    drawPoints(context, u, only, scale);
  });
}

function facts(all) {
  if (!all.length) return "nothing measured yet";
  if (isRelative(all)) return "several metrics: each curve as a part of its best";
  if (all.length > 1) return `${all.length} runs`;
  const [{ points, result, unit, name }] = all;
  const count = `${name}: ${points.length} positions`;
  return isFound(result) ? `${count}, answer ${withSigma(result.position, result.sigma, unit)}` : count;
}

function drawLegend(all) {
  const legend = byId("curve-legend");
  legend.hidden = all.length < 2;
  if (all.length < 2) return;
  legend.replaceChildren(...all.map((curve, i) => {
    const key = make("i", { className: `dash${i % kDashes.length}` });
    key.style.borderColor = `var(--${kColours[i % kColours.length]})`;
    return make("span", {}, key, `${curve.name}: ${verdictOf(curve)}`);
  }));
}

const verdictOf = ({ result, unit }) =>
  isFound(result) ? withSigma(result.position, result.sigma, unit) : result?.verdict ?? "no answer";

let tabled = "";

function drawTable(all) {
  const details = byId("curve-table");
  details.hidden = all.length !== 1;
  if (!details.open || all.length !== 1) return;
  const [{ points, unit }] = all, key = JSON.stringify([points.length, points.at(-1), unit]);
  if (key === tabled) return;
  tabled = key;
  const decimals = decimalsFor(Math.max(...points.map((p) => p.score)), 4);
  const columns = [{ name: "Order", number: true }, { name: `Position, ${unit}`, number: true }, { name: "Score", number: true }];
  const rows = points.map((p, i) => ({ cells: [String(i + 1), short(p.position), fixed(p.score, decimals)] }));
  details.lastElementChild.replaceChildren(table(columns, rows, "Focus curve"));
}

function draw() {
  const all = curves();
  plot ??= new Plot({
    box: byId("curve"), x: "", y: "", draw: drawAll,
    ranges: () => ({ x: xRange(curves()), y: yRange(scaled(curves())) }),
  });
  plot.label(`Lens position, ${all[0]?.unit || model.state?.lens?.unit || "steps"}`, isRelative(all) ? "Part of the best" : "Score");
  plot.show(all.length === 1 && isFound(all[0].result) ? all[0].result.fit ?? [] : []);
  byId("curve").setAttribute("aria-label", `Focus curve. ${facts(all)}`);
  say(byId("curve-facts"), facts(all));
  byId("curve-back").hidden = !model.opened;
  byId("curve-zoom").disabled = !isFound(all[0]?.result);
  drawLegend(all);
  drawTable(all);
}

function zoom() {
  model.isNear = !model.isNear;
  plot.isNear = false;
  byId("curve-zoom").setAttribute("aria-pressed", String(model.isNear));
  say(byId("curve-zoom"), model.isNear ? "All positions" : "Near the answer");
  tell("opened");
}

export function showCurve() {
  onTick("state began evaluated found ended opened", draw);
  on("began", () => { model.opened = null; });
  byId("curve-back").addEventListener("click", () => {
    model.opened = null;
    tell("opened");
  });
  byId("curve-zoom").addEventListener("click", zoom);
  byId("curve-table").addEventListener("toggle", () => tell("opened"));
}
