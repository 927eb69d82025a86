// SPDX-License-Identifier: Apache-2.0
// The lens: where it is, where it can go, and how it is sent there by hand.
import { short } from "./format.js";
import { byId, command, lastOnly, say } from "./page.js";
import { isBusy, mayChange } from "./model.js";
import { model, on, onTick } from "./store.js";

/** So long after it was touched the slider is the hand's, and does not follow the lens. */
const kHandMs = 1500;
/** A large step is this part of the travel. */
const kLargeSteps = 40;

const slider = byId("lens");
const push = lastOnly("lens");
let touchedAt = -Infinity;

const stepsOf = () => document.querySelectorAll("[data-step]");

/** A round number of the lens's own steps: 1, 2 or 5 times a power of ten. */
export function largeStep({ min, max, step }) {
  const wanted = (max - min) / kLargeSteps;
  const ten = 10 ** Math.floor(Math.log10(wanted));
  const round = [1, 2, 5, 10].map((k) => k * ten).filter((size) => size <= wanted).at(-1);
  return Math.max(Math.round(round / step), 1) * step;
}

/** Where a step leads: from stop to stop where the lens has them. */
export function stepTarget(lens, steps) {
  if (lens.stops?.length) return nextStop(lens, Math.sign(steps), Math.abs(steps) > 1 ? 5 : 1);
  const size = Math.abs(steps) > 1 ? largeStep(lens) : lens.step;
  return Math.min(Math.max(lens.position + Math.sign(steps) * size, lens.min), lens.max);
}

function nextStop({ stops, position }, direction, count) {
  const nearest = stops.reduce((best, stop, i) =>
    (Math.abs(stop - position) < Math.abs(stops[best] - position) ? i : best), 0);
  return stops[Math.min(Math.max(nearest + direction * count, 0), stops.length - 1)];
}

function sayLimits({ state }) {
  const { lens } = state;
  if (!lens) return;
  slider.min = lens.min;
  slider.max = lens.max;
  slider.step = lens.stops?.length ? "any" : lens.step;
  slider.disabled = !mayChange(state);
  say(byId("lens-min"), short(lens.min));
  say(byId("lens-max"), `${short(lens.max)}\u00a0${lens.unit}`);
  const sizes = lens.stops?.length ? ["5 stops", "1 stop"] : [short(largeStep(lens)), short(lens.step)];
  for (const button of stepsOf()) {
    const steps = Number(button.dataset.step), size = sizes[Math.abs(steps) > 1 ? 0 : 1];
    say(button, (steps < 0 ? "\u2212" : "+") + size);
    button.setAttribute("aria-label", `Lens ${steps < 0 ? "down" : "up"} by ${size} ${lens.stops?.length ? "" : lens.unit}`);
    button.disabled = !mayChange(state);
  }
}

function stateWords({ lens, activity }) {
  if (activity === "stopping") return "stopping";
  if (lens.moving) return "moving";
  return activity === "live" ? "at rest" : "measuring";
}

function sayPosition({ state }) {
  const lens = state?.lens;
  if (!lens) return say(byId("lens-state"), "none that moves");
  say(byId("lens-position"), `${short(lens.position)}\u00a0${lens.unit}`);
  say(byId("lens-state"), stateWords(state));
  slider.setAttribute("aria-valuetext", `${short(lens.position)} ${lens.unit}`);
  const isByHand = performance.now() - touchedAt < kHandMs && !isBusy(state);
  if (!isByHand && Number.isFinite(lens.position)) slider.value = lens.position;
}

const nearestStop = (stops, wanted) =>
  stops.reduce((best, stop) => (Math.abs(stop - wanted) < Math.abs(best - wanted) ? stop : best));

/** Within the limits where the lens knows its place. */
function byHowMuch({ position, ...lens }, target, { dataset }) {
  const steps = Number(dataset.step), size = Math.abs(steps) > 1 ? largeStep(lens) : lens.step;
  return Number.isFinite(position) ? target - position : Math.sign(steps) * size;
}

export function showLens() {
  on("state drive link", () => { if (model.state) sayLimits(model); });
  onTick("state frame", sayPosition);
  slider.addEventListener("input", () => {
    touchedAt = performance.now();
    const { stops } = model.state.lens, wanted = Number(slider.value);
    push({ position: stops?.length ? nearestStop(stops, wanted) : wanted });
  });
  for (const button of stepsOf()) {
    button.addEventListener("click", () => {
      const { lens } = model.state, target = stepTarget(lens, Number(button.dataset.step));
      // By how far, not to where: quick presses add up while the lens is still on its way.
      command("lens", lens.stops?.length ? { position: target } : { by: byHowMuch(lens, target, button) });
    });
  }
}
