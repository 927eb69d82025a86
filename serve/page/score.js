// SPDX-License-Identifier: Apache-2.0
// The score of now, large, and its running trace: for focusing by hand.
import { decimalsFor, fixed, short, thousandsFor } from "./format.js";
import { forgetBest, kTraceMs } from "./model.js";
import { byId, colour, fitted, say } from "./page.js";
import { model, onTick, tell } from "./store.js";

const kDigits = 4;
const kOthers = ["second", "soft"];
let top = 0;

function saySome({ trace, best, state }) {
  const now = trace.at(-1);
  if (!now) return;
  // Decimals follow the best score, so that places do not jump when the score of now is small.
  const { factor, words } = thousandsFor(best?.score);
  const decimals = decimalsFor(best?.score * factor, kDigits), told = (score) => fixed(score * factor, decimals);
  say(byId("score"), told(now.scores[0]));
  const place = best && Number.isFinite(best.position) ? ` at ${short(best.position, 5)} ${state?.lens?.unit ?? ""}` : "";
  const part = best?.score > 0 ? `${Math.round(100 * now.scores[0] / best.score)}\u00a0% of the best, ` : "";
  say(byId("score-best"), best ? `${part}${told(best.score)}${place}` : "");
  say(byId("score-metric"), `${words} ${state?.metric ?? ""}`.trim());
  sayOthers(now.scores, told);
}

function sayOthers(scores, told) {
  const others = scores.slice(1).map((score, i) => `${i + 2}: ${told(score)}`);
  say(byId("trace-facts"), others.length ? others.join("  ") : "last 20 s");
}

/** The scale grows at once, and shrinks only when half of it is unused. */
function scaleFor(trace) {
  let most = 0;
  for (const { scores } of trace) for (const score of scores) if (score > most) most = score;
  if (most > top || most < top / 2) top = most * 1.1;
  return top > 0 ? top : 1;
}

function drawTrace({ trace, best }) {
  const { context, width, height, scale } = fitted(byId("trace"));
  const last = trace.at(-1);
  if (!last) return;
  const high = scaleFor(trace);
  const xOf = (ms) => width * (1 + (ms - last.seen_ms) / kTraceMs);
  const yOf = (score) => height - 1 - (height - 2) * score / high;
  context.lineWidth = scale;
  context.strokeStyle = colour("line");
  line(context, [[0, height - scale / 2], [width, height - scale / 2]]);
  if (best && best.score <= high) {
    context.setLineDash([4 * scale, 4 * scale]);
    line(context, [[0, yOf(best.score)], [width, yOf(best.score)]]);
    context.setLineDash([]);
  }
  for (let k = last.scores.length - 1; k >= 0; --k) {
    context.strokeStyle = colour(k === 0 ? "accent" : kOthers[(k - 1) % kOthers.length]);
    context.lineWidth = (k === 0 ? 2 : 1.25) * scale;
    line(context, trace.filter((t) => k < t.scores.length).map((t) => [xOf(t.seen_ms), yOf(t.scores[k])]));
  }
}

function line(context, places) {
  context.beginPath();
  for (const [x, y] of places) context.lineTo(x, y);
  context.stroke();
}

export function showScore() {
  onTick("score state", saySome);
  onTick("score", drawTrace);
  byId("score-forget").addEventListener("click", () => {
    forgetBest(model);
    top = 0;
    tell("score");
  });
}
