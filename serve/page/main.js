// SPDX-License-Identifier: Apache-2.0
// Puts the parts of the page together, and lets events in.
import { listen } from "./api.js";
import { showAnswer } from "./answer.js";
import { showCalibration } from "./calibrate.js";
import { showCurve } from "./curve.js";
import { showDepth } from "./depth.js";
import { showDrive } from "./drive.js";
import { showLens } from "./lens.js";
import { showLooks } from "./looks.js";
import { showMeasure } from "./measure.js";
import { byId, say } from "./page.js";
import { showPicture } from "./picture.js";
import { showRuns } from "./runs.js";
import { showScore } from "./score.js";
import { showSettings } from "./settings.js";
import { model, on, take, tell } from "./store.js";
import { showWindows } from "./windows.js";

const parts = [showPicture, showWindows, showLooks, showScore, showMeasure, showAnswer, showCurve,
  showCalibration, showDepth, showLens, showSettings, showRuns, showDrive];
for (const show of parts) show();

function sayProblem(problem) {
  byId("problem").hidden = !problem;
  say(byId("problem"), problem ?? "");
}

/** What the page shows next to the picture: what is measured, or was measured last. */
on("state began", () => {
  const { activity, measurement } = model.state ?? {};
  const isPlain = activity === "live" || activity === "stopping";
  document.body.dataset.shows = (isPlain ? measurement?.kind : activity) ?? "";
});

on("state", () => {
  say(byId("rig"), model.state.description ? `${model.state.rig} \u2013 ${model.state.description}` : model.state.rig);
  sayProblem(model.state.problem);
  byId("rig").title = byId("rig").textContent;
});

listen(take, (isLinked, words, why) => {
  model.isLinked = isLinked;
  if (model.state) model.state.isLinked = isLinked;
  if (!isLinked) sayProblem(why);
  say(byId("link"), words);
  byId("link").classList.toggle("lost", !isLinked);
  tell("link");
});
