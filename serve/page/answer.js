// SPDX-License-Identifier: Apache-2.0
// What a measurement has found: the verdict in words, with what to try.
import { percent, short, withSigma } from "./format.js";
import { byId, make } from "./page.js";
import { model, on } from "./store.js";

const kVerbs = { aim: "Looking round", focus: "Focusing", sweep: "Sweeping", range: "Ranging", calibrate: "Calibrating", depth: "Mapping depth", capture: "Capturing" };

function running({ kind, points, positions_expected: expected }) {
  const count = points.length, positions = count === 1 ? "position" : "positions";
  return `${kVerbs[kind] ?? kind}: ${count}${expected ? ` of ${expected}` : ""} ${positions}`;
}

/** Whether there is an answer: other verdicts tell a position too, but it is no focus. */
export const isFound = (result) => result?.verdict === "focused" && Number.isFinite(result.position);

function headline(result, unit) {
  const { distance, position, sigma } = result;
  if (distance) return withSigma(distance.value, distance.sigma, distance.unit);
  return isFound(result) ? withSigma(position, sigma, unit) : "";
}

/** Where the focus was, below a distance. */
function place(result, unit) {
  const { distance, position, sigma } = result;
  return distance && isFound(result) ? `focus at ${withSigma(position, sigma, unit)}` : "";
}

function parts(measurement, unit) {
  const { result, status, error, warnings } = measurement;
  const out = [];
  const put = (className, text) => { if (text) out.push({ className, text }); };
  if (status === "running") put("verdict", running(measurement));
  if (status === "stopped") put("verdict doubt", "Stopped. The lens goes back to where it was.");
  if (status === "failed" || error) put("error", error ?? "It failed.");
  if (result) {
    put("big", headline(result, unit));
    put(result.verdict === "focused" ? "verdict" : "verdict doubt", verdict(result));
    put("small", place(result, unit));
    put("", result.words);
    if (status !== "failed" && result.error && result.error !== error) put("error", result.error);
    for (const lobe of secondLobes(result)) put("small", `also a lobe at ${short(lobe.position)} ${unit}`);
    if (result.folder && !result.words?.includes(result.folder)) put("", `Kept in ${result.folder}.`);
    if (result.advice?.length) out.push({ list: result.advice, title: "Advice" });
  }
  if (warnings?.length) out.push({ list: warnings, title: "Note" });
  return out;
}

/** Confidence is of a focus: beside "no-focus" it would read as its opposite. */
function verdict(result) {
  const { verdict: name, confidence } = result;
  if (!name) return "";
  return isFound(result) && Number.isFinite(confidence) ? `${name}, confidence ${percent(confidence, 0)}` : name;
}

/** All peaks but the one that is the answer. */
export function secondLobes({ lobes, position }) {
  if (!lobes?.length) return [];
  const distances = lobes.map((lobe) => Math.abs(lobe.position - (position ?? Infinity)));
  const own = distances.indexOf(Math.min(...distances));
  return lobes.filter((_, i) => i !== own);
}

function elementFor({ className, text, list, title }) {
  if (!list) return make("p", { className }, text);
  return make("div", {}, make("p", { className: "small" }, title),
    make("ul", {}, ...list.map((item) => make("li", {}, item))));
}

const kIdle = "Aim window 1 at what shall be sharp. Then press Focus.";
const kCalibrate = "Put the target at a known distance, type that, and press Measure.";
const kStage = "Type a distance and press Measure. This rig puts its target there by itself.";
let shown = "";

function sayProgress({ status, points, positions_expected: expected }) {
  const progress = byId("progress");
  progress.hidden = status !== "running";
  if (expected) progress.value = points.length / expected;
  else progress.removeAttribute("value");
}

function draw() {
  const measurement = model.state?.measurement, unit = model.state?.lens?.unit ?? "";
  if (!measurement) {
    const asks = model.state?.stage ? kStage : kCalibrate;
    const hint = model.state?.activity === "calibrate" ? asks : kIdle;
    if (hint !== shown) byId("answer").replaceChildren(make("p", { className: "small" }, hint));
    shown = hint;
    byId("progress").hidden = true;
    return;
  }
  sayProgress(measurement);
  const all = parts(measurement, unit), key = JSON.stringify(all);
  if (key === shown) return;
  shown = key;
  byId("answer").replaceChildren(...all.map(elementFor));
}

export function showAnswer() {
  on("state began evaluated warning found ended", draw);
}
