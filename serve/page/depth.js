// SPDX-License-Identifier: Apache-2.0
// The map of depth, as it grows.
import { short } from "./format.js";
import { byId, say } from "./page.js";
import { shade } from "./shades.js";
import { model, onTick } from "./store.js";

const kUnknown = [128, 128, 128, 90];

function drawScale() {
  const canvas = byId("map-scale"), context = canvas.getContext("2d");
  canvas.width = 128;
  canvas.height = 1;
  const image = context.createImageData(128, 1);
  for (let i = 0; i < 128; ++i) image.data.set(shade(i / 127), 4 * i);
  context.putImageData(image, 0, 0);
}

function draw({ map, state }) {
  byId("map").hidden = !map;
  if (!map) return;
  const { columns, rows, values, unit } = map, canvas = byId("map-picture");
  const known = values.filter((v) => v !== null);
  const low = known.reduce((a, b) => Math.min(a, b), Infinity), high = known.reduce((a, b) => Math.max(a, b), -Infinity);
  canvas.width = columns;
  canvas.height = rows;
  const context = canvas.getContext("2d"), image = context.createImageData(columns, rows);
  values.forEach((value, i) =>
    image.data.set(value === null ? kUnknown : shade((value - low) / (high - low || 1)), 4 * i));
  context.putImageData(image, 0, 0);
  drawScale();
  const isGrowing = state?.activity === "depth";
  say(byId("map-low"), known.length ? `${short(low, 5)}\u00a0${unit}` : "\u2013");
  say(byId("map-high"), known.length ? `${short(high, 5)}\u00a0${unit}` : "\u2013");
  say(byId("map-facts"), `${Math.round(100 * known.length / values.length)}\u00a0% known${isGrowing ? ", growing" : ""}; grey is none`);
}

export function showDepth() {
  onTick("map state began ended", draw);
}
