// SPDX-License-Identifier: Apache-2.0
// What the page computes, without a page.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";
import { streamsFor } from "../../serve/page/crowd.js";
import { thousandsFor, typed, withSigma } from "../../serve/page/format.js";
import * as geometry from "../../serve/page/geometry.js";
import { apply, emptyModel, mayChange } from "../../serve/page/model.js";
import { shade, shadeBytes } from "../../serve/page/shades.js";

const camera = { width: 640, height: 480 };
const live = { activity: "live", metric: "walsh-sequency:64", windows: [{ x: 0, y: 0, n: 64 }], read_only: false, drive: { you: false, driver: null, asking: [] }, lens: { position: 3 }, measurement: null };
const score = (value) => ({ stamp_ns: 0, position: 10 * value, scores: [value] });

function after(...events) {
  const model = emptyModel();
  for (const [name, data] of events) apply(model, name, structuredClone(data));
  return model;
}

test("a window stays within the picture", () => {
  assert.deepEqual(geometry.moved({ x: 570, y: 5, n: 64 }, 50, -50, camera), { x: 576, y: 0, n: 64 });
});

test("sides are powers of two that the picture has room for", () => {
  assert.equal(geometry.nearestSide(100, camera), 128);
  assert.equal(geometry.nearestSide(9999, camera), 256);
  assert.equal(geometry.nearestSide(1, camera), 8);
  assert.equal(geometry.largest({ width: 4000, height: 3000 }), 512);
});

test("a window grows about its centre, and at an edge inwards", () => {
  assert.deepEqual(geometry.resized({ x: 100, y: 100, n: 64 }, 128, camera), { x: 68, y: 68, n: 128 });
  assert.deepEqual(geometry.resized({ x: 0, y: 0, n: 64 }, 128, camera), { x: 0, y: 0, n: 128 });
});

test("a dragged corner leaves the opposite one where it is", () => {
  assert.deepEqual(geometry.stretched({ x: 100, y: 100, n: 64 }, 330, 200, camera), { x: 100, y: 100, n: 256 });
});

test("a new window does not hide the last", () => {
  assert.deepEqual(geometry.another([{ x: 288, y: 208, n: 64 }], camera), { x: 352, y: 208, n: 64 });
  assert.deepEqual(geometry.another([{ x: 576, y: 0, n: 64 }], camera), { x: 0, y: 64, n: 64 });
});

test("the trace forgets what is older than it shows; the best is kept until another window", () => {
  const model = after(["state", live]);
  for (const [seen_ms, value] of [[1000, 5], [15000, 2], [30000, 3]]) apply(model, "score", score(value), seen_ms);
  assert.deepEqual(model.trace.map((s) => s.scores[0]), [2, 3]);
  assert.deepEqual(model.best, { score: 5, position: 50 });
  apply(model, "state", { ...live, windows: [{ x: 8, y: 0, n: 64 }] });
  assert.equal(model.best, null);
});

test("a measurement grows by its events, and says how it ended", () => {
  const model = after(["state", live], ["began", { id: 7, kind: "sweep", positions: 3 }],
    ["evaluated", { position: 1, score: 2 }], ["warning", { text: "dark" }], ["warning", { text: "dark" }],
    ["evaluated", { position: 2, score: 4 }], ["ended", { id: 7, kind: "sweep", status: "stopped", error: null }]);
  const { points, status, warnings, positions_expected: expected } = model.state.measurement;
  assert.deepEqual([points.length, status, warnings, expected], [2, "stopped", ["dark"], 3]);
});

test("a state that has a point already does not double it", () => {
  const points = [{ position: 1, score: 2, from_ms: 5 }];
  const model = after(["state", { ...live, activity: "focus", measurement: { id: 1, kind: "focus", points } }],
    ["evaluated", { position: 1, score: 2, frames: 1 }]);
  assert.equal(model.state.measurement.points.length, 1);
});

test("states without a status do not take back how a measurement ended", () => {
  const measurement = { id: 1, kind: "focus", points: [] };
  const model = after(["state", { ...live, activity: "focus", measurement }], ["ended", { id: 1, status: "stopped" }], ["state", { ...live, measurement }]);
  assert.equal(model.state.measurement.status, "stopped");
  apply(model, "state", { ...live, activity: "focus", measurement: { ...measurement, id: 2 } });
  assert.equal(model.state.measurement.status, "running");
});

test("who may change what", () => {
  assert.ok(mayChange(live));
  assert.ok(!mayChange({ ...live, activity: "focus" }));
  assert.ok(!mayChange({ ...live, read_only: true }));
  assert.ok(!mayChange({ ...live, drive: { you: false, driver: "b", asking: [] } }));
});

test("unknown events are skipped", () => assert.equal(apply(emptyModel(), "toString", {}), false));

test("numbers have no more digits than their sigma", () => {
  assert.equal(withSigma(781.1920859, 0.0653, "steps"), "781.192\u00a0\u00b1\u00a00.065\u00a0steps");
  assert.equal(withSigma(-3, 0, "mm"), "\u22123\u00a0mm");
  assert.equal(typed("1,5"), 1.5);
  assert.equal(typed("near"), null);
});

test("small scores are told in powers of a thousand", () => {
  assert.deepEqual(thousandsFor(2.18e-5), { factor: 1e6, words: "\u00d7 10\u207b\u2076" });
  assert.equal(thousandsFor(3e-10).factor, 1e12);
  assert.equal(thousandsFor(0.2).words, "");
  assert.equal(thousandsFor(undefined).factor, 1);
});

test("bytes are coloured as their parts are", () => {
  const image = { data: new Uint8ClampedArray(4 * 256) };
  shadeBytes(image, Uint8Array.from({ length: 256 }, (_, i) => i));
  for (let i = 0; i < 256; ++i) assert.deepEqual([...image.data.slice(4 * i, 4 * i + 4)], shade(i / 255));
});

test("shades go from dark to bright", () => {
  const grey = ([r, g, b]) => 0.3 * r + 0.59 * g + 0.11 * b;
  const greys = Array.from({ length: 20 }, (_, i) => grey(shade(i / 19)));
  assert.ok(greys.every((g, i) => i === 0 || g > greys[i - 1]));
});

test("the page's shades are those of depth.png", async () => {
  const source = await readFile(new URL("../../mapping/colour_map.cpp", import.meta.url), "utf8");
  const places = source.match(/kViridis = \{([^;]*)\};/)[1].match(/0x[0-9a-f]{2}/g).map(Number);
  assert.equal(places.length, 27);
  assert.deepEqual(Array.from({ length: 9 }, (_, i) => shade(i / 8).slice(0, 3)).flat(), places);
});

test("pages of one browser leave one of its six connections free", () => {
  for (const pages of [1, 2, 3, 4, 5]) assert.ok(pages + streamsFor(pages) <= 5, `${pages} pages`);
});
