// SPDX-License-Identifier: Apache-2.0
// The buttons that start a measurement, the one that stops it, and what they need to know.
import { send } from "./api.js";
import { typed } from "./format.js";
import { byId, command, make, notice, say, trying } from "./page.js";
import { isBusy, mayChange, mayDrive } from "./model.js";
import { model, on, onTick } from "./store.js";

const buttons = () => document.querySelectorAll("[data-action]");

/** What was typed, or nothing where a field is empty. Throws where it is no number. */
function number(id, name) {
  const { value } = byId(id);
  if (value.trim() === "") return {};
  const said = typed(value);
  if (said === null) throw new Error(`${name} is no number: "${value}"`);
  return { [id]: said };
}

const ends = () => ({ ...number("from", "From"), ...number("to", "To") });

const travel = () => ({ ...ends(), ...number("step", "Step") });

const named = (name) => (name ? { name } : {});

/** A calibration says which way is near, where there is one. */
const nearBy = (window, calibration) => (window === "nearest" && calibration ? { calibration } : {});

const bodies = {
  aim: ({ window }) => ({ window, ...ends(), ...nearBy(window, byId("calibration-choice").value) }),
  focus: () => ({}),
  sweep: travel,
  range: () => ({ calibration: byId("calibration-choice").value }),
  calibrate: () => named(byId("calibration-name").value.trim()),
  depth: travel,
  capture: () => number("frames", "Frames"),
};

async function start({ action, ...more }) {
  const answer = await trying(async () => send(action, bodies[action](more)));
  if (answer?.folder) say(byId("action-hint"), `Kept in ${answer.folder}.`);
}

/** Why a button does nothing now; empty if it does. */
function whyNot(action, state) {
  if (action === "range" && !state.calibrations?.length) return "Range needs a calibration: Calibrate first.";
  if (action === "capture" && state.folder === false) return "Capture needs a folder: fathom serve --folder.";
  if (state.lens === null && action !== "capture") return "No lens that moves is here.";
  return "";
}

function whyNone(state) {
  if (state.isLinked === false) return "No connection to the service.";
  if (state.read_only) return "Shown only: this service was started with --read-only.";
  if (!mayDrive(state)) return "Another page drives. Ask to take over, or watch.";
  return isBusy(state) ? "" : null;
}

function sayButtons({ state }) {
  const none = whyNone(state);
  const reasons = [];
  for (const button of buttons()) {
    const why = none ?? whyNot(button.dataset.action, state);
    button.disabled = none !== null || why !== "";
    button.title = why;
    if (none === null && why) reasons.push(why);
  }
  say(byId("action-hint"), (none ?? reasons[0] ?? "") || "\u00a0");
}

const kNames = { aim: "Looking round", focus: "Focusing", sweep: "Sweeping", range: "Ranging", calibrate: "Calibrating", depth: "Mapping depth", capture: "Capturing", stopping: "Stopping" };

function sayStop({ state }) {
  const stop = byId("stop");
  stop.hidden = state.read_only;
  stop.classList.toggle("idle", state.activity === "live" && !state.lens?.moving);
  say(stop, state.activity === "stopping" ? "Stopping" : "Stop");
  document.title = state.activity === "live" ? "Fathom" : `${kNames[state.activity] ?? state.activity} \u2013 Fathom`;
}

let listed = "";

function sayChoices({ state }) {
  const names = state.calibrations ?? [];
  if (JSON.stringify(names) === listed) return;
  listed = JSON.stringify(names);
  const select = byId("calibration-choice"), before = select.value;
  select.replaceChildren(...names.map((name) => make("option", { value: name }, name)));
  if (!names.length) select.append(make("option", { value: "" }, "none yet"));
  select.value = names.includes(before) ? before : names.at(-1) ?? "";
}

function sayUnit({ state }) {
  const { lens } = state;
  say(document.querySelector("[data-unit]"), lens ? `${lens.unit}, ${lens.min} to ${lens.max}` : "");
}

/** Stop asks nobody: it works for who only watches, too, and in the middle of everything. */
export async function stopNow() {
  say(byId("stop"), "Stopping");
  await command("stop", {});
  if (model.state) sayStop(model);
}

export function showMeasure() {
  on("state drive link", () => {
    if (!model.state) return;
    for (const sayIt of [sayButtons, sayStop, sayChoices, sayUnit]) sayIt(model);
  });
  onTick("frame", () => { if (model.state) sayStop(model); });
  for (const button of buttons()) {
    button.addEventListener("click", () => {
      if (!mayChange(model.state)) return notice("A measurement is running, or another page drives.");
      start(button.dataset);
    });
  }
  byId("stop").addEventListener("click", stopNow);
  addEventListener("keydown", (event) => { if (event.key === "Escape") stopNow(); });
}
