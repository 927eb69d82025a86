// SPDX-License-Identifier: Apache-2.0
// The live picture, the facts below it, and the marks of pixels that are too bright or too dark.
import { address } from "./api.js";
import { joinCrowd } from "./crowd.js";
import { fixed, percent } from "./format.js";
import { byId, say } from "./page.js";
import { model, on, onTick, tell } from "./store.js";

const kRetryMs = 1000, kStillMs = 500;
/** Each is as fresh as any; more of them cost a processor more than an eye sees. */
const kMostFps = 15;
/** The marks are looked for in a small copy: that costs little, and a pixel of it is seen. */
const kMarksWidth = 320;
/** JPEG does not keep a value to the last bit. */
const kOver = 252, kUnder = 3;
const kStripe = 4;
const kOverColour = [230, 159, 0, 255], kUnderColour = [86, 180, 233, 255];

const stream = byId("stream"), picture = byId("picture"), marks = byId("marks");
let isStreamed = false, isStill = true;
let copy = null, isMarked = false;

/** No wider than it is shown, where that is less than the camera gives; no oftener than eyes need. */
function wanted(camera) {
  const shown = picture.clientWidth * (devicePixelRatio || 1);
  const width = Math.ceil(shown / 160) * 160;
  return `bare=1&fps=${kMostFps}${width > 0 && width < camera.width ? `&width=${width}` : ""}`;
}

function start() {
  const camera = model.state?.camera;
  if (!camera || document.hidden || !model.isLinked) return;
  isStreamed = true;
  stream.src = address(isStill ? "frame?format=png" : `stream.mjpg?${wanted(camera)}`) + `&began=${Date.now()}`;
}

/** A stream that nobody sees costs the rig nothing. */
function stop() {
  isStreamed = false;
  stream.removeAttribute("src");
}

/**
 * Single pictures hold no connection, which other pages of this browser need. A stream must end
 * first: a browser keeps it until the next picture is there, which may wait for its connection.
 */
function become(mayStream) {
  if (isStill !== mayStream) return;
  isStill = !mayStream;
  if (!isStreamed) return;
  stop();
  setTimeout(start);
}

function sayNone(words) {
  byId("no-picture").hidden = !words;
  say(byId("no-picture"), words);
}

function shape() {
  const camera = model.state?.camera;
  if (!camera) return;
  const ratio = camera.width / camera.height;
  picture.style.aspectRatio = `${camera.width} / ${camera.height}`;
  const most = innerWidth <= 820 ? 0.56 : 0.55;
  picture.style.width = `min(100%, ${(most * innerHeight * ratio).toFixed(0)}px)`;
}

const isTooBright = (pixels, at) => Math.max(pixels[at], pixels[at + 1], pixels[at + 2]) >= kOver;
const isTooDark = (pixels, at) => Math.max(pixels[at], pixels[at + 1], pixels[at + 2]) <= kUnder;

/** Stripes that lean to one side over what is too bright, to the other over what is too dark. */
export function stripes(from, to, width) {
  for (let at = 0; at < from.length; at += 4) {
    const x = (at / 4) % width, y = Math.floor(at / 4 / width);
    const bright = isTooBright(from, at) && (x + y) % kStripe < kStripe / 2;
    const dark = isTooDark(from, at) && (x - y + kStripe * width) % kStripe < kStripe / 2;
    if (bright || dark) to.set(bright ? kOverColour : kUnderColour, at);
  }
}

/** To read a picture back costs more than all else here; the service has counted already. */
const hasMarks = (frame) => !frame || frame.over > 0 || frame.under > 0;

function drawMarks() {
  const context = marks.getContext("2d");
  const isWanted = byId("mark").checked && stream.naturalWidth > 0;
  if (!isWanted || !hasMarks(model.frame)) {
    if (isMarked) context.clearRect(0, 0, marks.width, marks.height);
    isMarked = false;
    return;
  }
  isMarked = true;
  const width = Math.min(kMarksWidth, stream.naturalWidth);
  const height = Math.max(Math.round(width * stream.naturalHeight / stream.naturalWidth), 1);
  copy ??= document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  for (const canvas of [copy.canvas, marks]) {
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
  }
  copy.drawImage(stream, 0, 0, width, height);
  const out = context.createImageData(width, height);
  stripes(copy.getImageData(0, 0, width, height).data, out.data, width);
  context.putImageData(out, 0, 0);
}

function sayFacts({ frame }) {
  say(byId("fps"), frame ? `${fixed(frame.fps, 1)}\u00a0/s` : "\u2013");
  say(byId("mean"), frame ? percent(frame.mean, 1) : "\u2013");
  say(byId("over"), frame ? percent(frame.over) : "\u2013");
  say(byId("under"), frame ? percent(frame.under) : "\u2013");
}

function came() {
  sayNone("");
  tell("picture");
  if (isStill) setTimeout(start, kStillMs);
}

function failed() {
  if (!isStreamed) return;
  sayNone(model.isLinked ? "No picture" : "No connection");
  setTimeout(start, kRetryMs);
}

/** A picture that stands still looks as if it were live. */
function linked() {
  if (model.isLinked) start();
  else sayNone("No connection: this picture is old");
}

export function showPicture() {
  on("state", shape);
  on("state", () => { if (!isStreamed) start(); });
  on("link", linked);
  onTick("frame", sayFacts);
  onTick("frame picture", drawMarks);
  addEventListener("resize", shape);
  document.addEventListener("visibilitychange", () => (document.hidden ? stop() : start()));
  stream.addEventListener("load", came);
  stream.addEventListener("error", failed);
  byId("mark").addEventListener("change", drawMarks);
  joinCrowd(become);
}
