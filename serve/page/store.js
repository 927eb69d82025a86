// SPDX-License-Identifier: Apache-2.0
// One model for all parts of the page. Parts hear of events by name; what is drawn is drawn at most
// eight times a second, and not at all while nobody sees it.
import { apply, emptyModel } from "./model.js";

const kTickMs = 125;
/** Numbers that change oftener cannot be read, and every change is laid out and painted. */
const kReadTicks = 2;

export const model = emptyModel();
const hearers = new Map();
const drawers = [];

/** Calls hear(model) after each of these events. */
export function on(names, hear) {
  for (const name of names.split(" ")) hearers.set(name, [...(hearers.get(name) ?? []), hear]);
}

/** Calls hearers as if an event had come; for what the page itself changes. */
export function tell(name) {
  for (const hear of hearers.get(name) ?? []) hear(model);
}

export function take(name, data) {
  if (apply(model, name, data, performance.now())) tell(name);
}

/** Draws soon after one of these events, however many come. */
export const onTick = (names, draw) => drawOn(names, draw, 1);

/** The same for what is read: at most four times a second. */
export const onRead = (names, draw) => drawOn(names, draw, kReadTicks);

function drawOn(names, draw, every) {
  const drawer = { draw, every, due: true };
  drawers.push(drawer);
  on(names, () => { drawer.due = true; });
}

let ticks = 0;
setInterval(() => {
  if (document.hidden) return;
  ticks += 1;
  for (const drawer of drawers) {
    if (!drawer.due || ticks % drawer.every !== 0) continue;
    drawer.due = false;
    drawer.draw(model);
  }
}, kTickMs);

/** All is drawn again, as after a change of colours or of size. */
export function redraw() {
  for (const drawer of drawers) drawer.due = true;
}
addEventListener("resize", redraw);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
