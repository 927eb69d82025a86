// SPDX-License-Identifier: Apache-2.0
// One model for all parts of the page. Parts hear of events by name. What is drawn is drawn at most five
// times a second, all at once, and not at all while nobody sees it: each time costs a frame of the screen.
import { apply, emptyModel } from "./model.js";

const kTickMs = 200;

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
export function onTick(names, draw) {
  const drawer = { draw, due: true };
  drawers.push(drawer);
  on(names, () => { drawer.due = true; });
}

setInterval(() => {
  if (document.hidden) return;
  for (const drawer of drawers) {
    if (!drawer.due) continue;
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
