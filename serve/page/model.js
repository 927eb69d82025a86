// SPDX-License-Identifier: Apache-2.0
// What the page knows, and how events change it. Nothing here touches the page.

/** Scores are kept for the trace this long. */
export const kTraceMs = 20000;

export function emptyModel() {
  return {
    state: null, frame: null, spectrum: null, map: null,
    trace: [],    // {seen_ms, position, scores}; seen_ms by the page's clock
    best: null,   // {score, position} of window 1 since it was forgotten
    offered: {},  // metrics and searches, as the service lists them
  };
}

const changes = {
  state(model, state) {
    if (forgets(model.state, state)) forgetBest(model);
    const last = model.state?.measurement ?? null;
    model.state = state;
    state.measurement = state.measurement ? withStatus(state.measurement, last, state) : ended(last);
    if (state.map !== undefined) model.map = state.map;
  },
  frame(model, frame) {
    model.frame = frame;
    if (!model.state?.lens) return;
    if (typeof frame.position === "number") model.state.lens.position = frame.position;
    if (typeof frame.moving === "boolean") model.state.lens.moving = frame.moving;
  },
  // By the page's clock: a simulated rig's time jumps, and a recording's stands still.
  score(model, { position, scores }, now_ms) {
    model.trace.push({ seen_ms: now_ms, position, scores });
    while (model.trace[0].seen_ms < now_ms - kTraceMs) model.trace.shift();
    if (!model.best || scores[0] > model.best.score) model.best = { score: scores[0], position };
  },
  spectrum(model, spectrum) { model.spectrum = spectrum; },
  began(model, { id, kind, positions, scatter }) {
    if (!model.state) return;
    model.state.measurement = {
      id, kind, status: "running", points: [], positions_expected: positions ?? 0,
      scatter: scatter ?? 0, warnings: [], result: null,
    };
    if (kind === "depth") model.map = null;
  },
  evaluated(model, point) {
    const points = model.state?.measurement?.points;
    const last = points?.at(-1);
    // A state that was sent in between has it already.
    if (points && !(last?.position === point.position && last.score === point.score)) points.push(point);
  },
  warning(model, { text }) {
    const warnings = model.state?.measurement?.warnings;
    if (warnings && !warnings.includes(text)) warnings.push(text);
  },
  found(model, result) {
    if (model.state?.measurement) model.state.measurement.result = result;
  },
  ended(model, { id, status, error }) {
    const measurement = model.state?.measurement;
    if (measurement && measurement.id === id) Object.assign(measurement, { status, error: error ?? null });
  },
  map(model, map) { model.map = map; },
  drive(model, drive) { if (model.state) model.state.drive = drive; },
};

/** The last measurement stays to be seen when the service knows of none any more. */
const ended = (last) => (last?.status === "running" ? null : last);

/** A state does not say how a measurement ended; what "ended" said of it is kept. */
function withStatus(measurement, last, state) {
  const known = last?.id === measurement.id && last.status !== "running" ? last : null;
  const guess = state.activity === "live" ? "done" : "running";
  return {
    warnings: [], points: [], ...measurement, scatter: measurement.scatter ?? last?.scatter ?? 0,
    status: measurement.status ?? known?.status ?? guess,
    error: measurement.error ?? known?.error ?? measurement.result?.error ?? null,
  };
}

/** Changes the model as an event says that came at now_ms. Returns whether it did: events of later versions are skipped. */
export function apply(model, name, data, now_ms = 0) {
  if (!Object.hasOwn(changes, name)) return false;
  changes[name](model, data, now_ms);
  return true;
}

export function forgetBest(model) {
  model.best = null;
}

/** Another window or metric makes other scores. */
function forgets(before, after) {
  const what = (state) => JSON.stringify([state?.metric, state?.windows?.[0]]);
  return before !== null && what(before) !== what(after);
}

/** Whether a measurement runs, or is being stopped. */
export const isBusy = (state) => !!state && state.activity !== "live";

/** Whether this page may send commands: it drives, or nobody does, and somebody hears it. */
export const mayDrive = (state) =>
  !!state && state.isLinked !== false && !state.read_only && (state.drive.you || !state.drive.driver);

/** Whether the page may change what is measured now. */
export const mayChange = (state) => mayDrive(state) && !isBusy(state);
