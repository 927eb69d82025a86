// SPDX-License-Identifier: Apache-2.0
// Runs that were kept: listed, opened, compared, computed again, downloaded.
import { address, get, send } from "./api.js";
import { when, withSigma } from "./format.js";
import { byId, make, notice, say, table, trying } from "./page.js";
import { mayDrive } from "./model.js";
import { model, on, tell } from "./store.js";

const chosen = new Set();
let listed = [];
/** What computing a run again said, by the run's id. */
const said = new Map();

/** The curves that a run file holds. */
export function curvesOf(file, name) {
  const { setup, runs } = file;
  return runs.map((run, i) => ({
    name: runs.length > 1 ? `${name}, ${i + 1}` : name,
    unit: setup.lens.unit, metric: setup.metric, scatter: run.repeat_scatter,
    points: run.evaluations.map(({ position, score }) => ({ position, score })),
    result: run.focus ? resultOf(run.focus) : null,
  }));
}

function resultOf({ result, position, sigma, confidence, peaks, lobes }) {
  return {
    verdict: result, confidence, sigma, position,
    lobes: peaks?.map((peak) => ({ position: peak.position, score: peak.score })) ?? (lobes ?? []).map((p) => ({ position: p })),
    fit: [],
  };
}

async function open(ids) {
  const opened = await trying(async () => {
    const files = await Promise.all(ids.map((id) => get(`runs/${encodeURIComponent(id)}`)));
    return files.flatMap((file, i) => curvesOf(file, nameOf(ids[i])));
  });
  if (!opened) return;
  if (!opened.some((curve) => curve.points.length)) return notice("This run holds no curve.");
  model.opened = opened;
  tell("opened");
  byId("curve-title").scrollIntoView({ block: "nearest" });
}

function nameOf(id) {
  const run = listed.find((r) => r.id === id);
  return run ? `${run.kind} ${when(run.when)}` : id;
}

async function rerun(id) {
  said.set(id, "computing");
  draw();
  const answer = await trying(() => send(`runs/${encodeURIComponent(id)}/rerun`));
  said.set(id, answer ? answer.text || (answer.same ? "same answer" : "another answer") : "");
  draw();
}

function actions({ id }) {
  const opens = make("button", { type: "button" }, "Open");
  opens.addEventListener("click", () => open([id]));
  const again = make("button", { type: "button", disabled: !mayDrive(model.state) }, "Rerun");
  again.addEventListener("click", () => rerun(id));
  const file = make("a", { href: address(`runs/${encodeURIComponent(id)}/file`), download: `${id}.json` }, "Download");
  for (const element of [opens, again, file]) element.setAttribute("aria-label", `${element.textContent} ${nameOf(id)}`);
  return make("span", {}, opens, " ", again, " ", file);
}

function tick({ id }) {
  const box = make("input", { type: "checkbox", checked: chosen.has(id), ariaLabel: `Compare ${nameOf(id)}` });
  box.addEventListener("change", () => {
    if (box.checked) chosen.add(id);
    else chosen.delete(id);
    sayCompare();
  });
  return box;
}

const sayCompare = () => { byId("runs-compare").disabled = chosen.size < 2; };

function draw() {
  if (!listed.length) {
    byId("runs").replaceChildren(make("p", { className: "hint" }, "None yet: a measurement leaves one here."));
    return;
  }
  const unit = model.state?.lens?.unit ?? "";
  const columns = [{ name: "" }, { name: "When" }, { name: "What" }, { name: "Answer", number: true }, { name: "Verdict" }, { name: "" }, { name: "" }];
  const rows = listed.map((run) => ({
    cells: [tick(run), when(run.when), run.kind,
      run.verdict === "focused" && Number.isFinite(run.position) ? withSigma(run.position, run.sigma, unit) : "\u2013",
      run.verdict ?? "\u2013", actions(run), said.get(run.id) ?? ""],
  }));
  byId("runs").replaceChildren(table(columns, rows, "Runs"));
  sayCompare();
}

async function list() {
  const runs = await get("runs").catch(() => null);
  if (!runs || JSON.stringify(runs) === JSON.stringify(listed)) return;
  listed = runs;
  for (const id of chosen) if (!runs.some((run) => run.id === id)) chosen.delete(id);
  draw();
}

export function showRuns() {
  on("ended link", list);
  byId("runs-compare").addEventListener("click", () => open([...chosen]));
  say(byId("runs-compare"), "Compare");
  draw();
}
