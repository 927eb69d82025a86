// SPDX-License-Identifier: Apache-2.0
// What is beside the picture: the loupe, the spectrum and the histogram.
import { shadeBytes } from "./shades.js";
import { byId, fitted, say } from "./page.js";
import { model, onTick } from "./store.js";
import { chosen } from "./windows.js";

/** A loupe that shows more of the picture does not enlarge it any more. */
const kLoupeMost = 128;

function drawLoupe() {
  const window = chosen(), stream = byId("stream"), canvas = byId("loupe");
  if (!window || !(stream.naturalWidth > 0)) return;
  const { context, width } = fitted(canvas);
  const side = Math.min(window.n, kLoupeMost), scale = stream.naturalWidth / model.state.camera.width;
  const left = window.x + (window.n - side) / 2, top = window.y + (window.n - side) / 2;
  context.imageSmoothingEnabled = false;
  context.drawImage(stream, left * scale, top * scale, side * scale, side * scale, 0, 0, width, width);
  say(byId("loupe-facts"), `${side} px, ${(canvas.clientWidth / side).toFixed(1)}\u00d7`);
}

const bytesOf = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));

function drawSpectrum({ spectrum }) {
  if (!spectrum) return;
  const { n } = spectrum, canvas = byId("spectrum"), values = bytesOf(spectrum.db);
  if (canvas.width !== n) canvas.width = n;
  if (canvas.height !== n) canvas.height = n;
  const context = canvas.getContext("2d"), image = context.createImageData(n, n);
  shadeBytes(image, values);
  context.putImageData(image, 0, 0);
  say(byId("spectrum-facts"), "80 dB");
}

function drawHistogram({ frame }) {
  if (!frame?.histogram) return;
  const { context, width, height } = fitted(byId("histogram"));
  const bins = frame.histogram, most = Math.sqrt(Math.max(...bins, 1e-12));
  bins.forEach((count, i) => {
    const isLast = i === bins.length - 1;
    context.fillStyle = isLast ? "#e69f00" : i === 0 ? "#56b4e9" : "#c3cbd0";
    const left = Math.floor(i * width / bins.length), right = Math.floor((i + 1) * width / bins.length);
    const tall = Math.sqrt(count) / most * (height - 2);
    context.fillRect(left, height - tall, right - left, tall);
  });
  say(byId("histogram-facts"), `0 to ${model.state?.camera.max_value ?? 255}`);
}

export function showLooks() {
  onTick("score frame picture windows", drawLoupe);
  onTick("spectrum", drawSpectrum);
  onTick("frame", drawHistogram);
}
