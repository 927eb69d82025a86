// SPDX-License-Identifier: Apache-2.0
// A calibration: distances asked for one by one, the curve through them, residuals, outliers.
import { fixed, short, typed, withSigma } from "./format.js";
import { byId, colour, command, notice, say, table } from "./page.js";
import { mayDrive } from "./model.js";
import { ends, inside, placeOn, Plot } from "./plot.js";
import { model, on, onTick } from "./store.js";

/** A fit with fewer says little of itself. */
const kEnough = 5;
const kUnit = "mm";

let plot = null;

/** Each point with what the fit says of it: {distance, position, sigma, residual, outlier}. */
function points() {
  const { points: measured = [], fit } = model.state?.calibration ?? {};
  return measured.map((point, i) => ({ ...point, residual: fit?.residuals_mm?.[i], outlier: !!fit?.left_out?.[i] }));
}

/** Pairs of distance and position, from near to far. */
const curve = () => (model.state?.calibration?.fit?.curve ?? []).map(([position, distance]) => [distance, position])
  .sort((a, b) => a[0] - b[0]);

function drawPoints(u) {
  inside(u, (context, _, scale) => {
    for (const { distance, position, sigma, outlier } of points()) {
      const [x, y] = placeOn(u, distance, position);
      context.strokeStyle = context.fillStyle = colour(outlier ? "second" : "accent");
      context.lineWidth = 1.5 * scale;
      const [, low] = placeOn(u, distance, position - sigma), [, high] = placeOn(u, distance, position + sigma);
      context.strokeRect(x, high, 0, low - high);
      context.beginPath();
      context.arc(x, y, 4.5 * scale, 0, 2 * Math.PI);
      if (outlier) context.stroke();
      else context.fill();
    }
  });
}

function ranges() {
  return {
    x: ends([...points().map((p) => p.distance), ...curve().map((p) => p[0])], [0, 1]),
    y: ends([...points().map((p) => p.position), ...curve().map((p) => p[1])], [0, 1]),
  };
}

function sayForm({ state }) {
  const { calibration } = state, form = byId("next-distance");
  const waits = state.activity === "calibrate" && calibration?.waiting_for_next && mayDrive(state);
  if (waits && form.hidden) {
    form.hidden = false;
    byId("distance").focus({ preventScroll: true });
  }
  form.hidden = !waits;
  say(byId("distance-label"), state.stage ? `Distance to put the target at, ${kUnit}` : `Distance of the target now, ${kUnit}`);
  byId("calibration-done").disabled = points().length < 2;
}

function facts({ state }) {
  const { calibration } = state, count = points().length;
  if (calibration.fit) {
    const { name, model: formula, equation, position_scatter: scatter } = calibration.fit;
    const of = `${formula}: ${equation}; a focus scatters by ${short(scatter, 2)} ${state.lens.unit}`;
    return name ? `${of}; kept as ${name}` : of;
  }
  if (count < kEnough) return `${count} of at least ${kEnough} distances, from the nearest to the farthest`;
  return `${count} distances`;
}

function drawTable({ state }) {
  const unit = state.lens?.unit ?? "";
  const columns = [{ name: `Distance, ${kUnit}`, number: true },
    { name: `Focus, ${unit}`, number: true }, { name: "Residual, mm", number: true }, { name: "" }];
  const rows = points().map((p) => ({
    className: p.outlier ? "outlier" : "",
    cells: [short(p.distance), withSigma(p.position, p.sigma, ""),
      Number.isFinite(p.residual) ? fixed(p.residual, 2) : "\u2013", p.outlier ? "outlier" : ""],
  }));
  byId("calibration-table").replaceChildren(table(columns, rows, "Points of the calibration"));
}

let drawn = "";

function draw() {
  const { state } = model, calibration = state?.calibration;
  byId("calibration").hidden = !calibration;
  if (!calibration) return;
  say(byId("calibration-facts"), facts(model));
    plot ??= new Plot({ box: byId("calibration-plot"), x: `Distance, ${kUnit}`, y: `Focus, ${state.lens?.unit ?? ""}`, ranges, draw: drawPoints });
  plot.show(curve());
  const key = JSON.stringify([calibration.points, calibration.fit]);
  if (key === drawn) return;
  drawn = key;
  drawTable(model);
}

export function showCalibration() {
  on("state drive link", () => { if (model.state) sayForm(model); });
  onTick("state", draw);
  byId("next-distance").addEventListener("submit", (event) => {
    event.preventDefault();
    const distance = typed(byId("distance").value);
    if (!(distance > 0)) return notice("A distance is a number above 0, such as 800.");
    byId("distance").value = "";
    command("calibrate/next", { distance });
  });
  byId("calibration-done").addEventListener("click", () => command("calibrate/done"));
}
