// SPDX-License-Identifier: Apache-2.0
// A picture, a focus curve and a spectrum that are the same every time.
import { crc32, deflateSync } from "node:zlib";

export const kWidth = 640, kHeight = 480;

/** Numbers 0..1 that repeat from run to run. */
function random(seed) {
  let state = seed;
  return () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
}

function addBlocks(pixels, side, strength, next) {
  const columns = Math.ceil(kWidth / side);
  const values = Array.from({ length: columns * Math.ceil(kHeight / side) }, () => (next() - 0.5) * strength);
  for (let y = 0; y < kHeight; ++y) {
    for (let x = 0; x < kWidth; ++x) {
      pixels[y * kWidth + x] += values[Math.floor(y / side) * columns + Math.floor(x / side)];
    }
  }
}

/** Blocks of several sizes, a disc that is too bright at the right, and a corner that is too dark. */
export function greys() {
  const pixels = new Float64Array(kWidth * kHeight).fill(120), next = random(7);
  for (const [side, strength] of [[40, 60], [16, 50], [6, 50], [2, 30]]) addBlocks(pixels, side, strength, next);
  return Uint8Array.from(pixels, (value, at) => {
    const x = at % kWidth, y = Math.floor(at / kWidth);
    if (Math.hypot(x - 540, y - 90) < 42) return 255;
    if (x + (kHeight - y) < 120) return 0;
    return Math.min(Math.max(value, 12), 240);
  });
}

function chunk(name, data) {
  const body = Buffer.concat([Buffer.from(name, "latin1"), data]), out = Buffer.alloc(body.length + 8);
  out.writeUInt32BE(data.length, 0);
  body.copy(out, 4);
  out.writeUInt32BE(crc32(body), body.length + 4);
  return out;
}

/** The picture as PNG, which a browser takes in a stream as it takes JPEG. */
export function picture() {
  const rows = Buffer.alloc(kHeight * (kWidth + 1)), pixels = greys();
  for (let y = 0; y < kHeight; ++y) rows.set(pixels.subarray(y * kWidth, (y + 1) * kWidth), y * (kWidth + 1) + 1);
  const head = Buffer.alloc(13);
  head.writeUInt32BE(kWidth, 0);
  head.writeUInt32BE(kHeight, 4);
  head.set([8, 0, 0, 0, 0], 8);
  return Buffer.concat([Buffer.from("\x89PNG\r\n\x1a\n", "latin1"), chunk("IHDR", head),
    chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}

export const kPeak = 781.19, kFloor = 0.0153, kHalfWidth = 29.4;

/** A Lorentzian, and a lower lobe. */
export const scoreAt = (position) => kFloor + 0.215 / (1 + ((position - kPeak) / kHalfWidth) ** 2) +
  0.05 / (1 + ((position - 430) / 35) ** 2);

export const kSearched = [0, 61, 182, 303, 424, 526, 647, 768, 795, 802, 786, 777, 758];

export function focusResult() {
  const fit = Array.from({ length: 81 }, (_, i) => 700 + 2 * i).map((x) => [x, scoreAt(x)]);
  return {
    position: kPeak, sigma: 0.067, confidence: 0.993, verdict: "focused", reason: "stands-out",
    words: "the peak stands 983 times as high as the noise at the floor; 7.2 times are needed",
    advice: [], lobes: [{ position: kPeak, score: scoreAt(kPeak) }, { position: 430, score: scoreAt(430) }],
    fit, distance: null, error: null, run: "2026-11-30T11-59-46-focus-554f5976",
  };
}

/** Bright in the middle, along both axes. */
export function spectrum() {
  const n = 64, values = new Uint8Array(n * n);
  for (let y = 0; y < n; ++y) {
    for (let x = 0; x < n; ++x) {
      const r = Math.hypot(x - 32, y - 32), axis = Math.min(Math.abs(x - 32), Math.abs(y - 32));
      values[y * n + x] = Math.max(250 - 6 * r - 3 * Math.min(axis, 20), 0);
    }
  }
  return { n, db: Buffer.from(values).toString("base64") };
}

export function histogram() {
  const bins = Array.from({ length: 64 }, (_, i) => 9000 * Math.exp(-(((i - 30) / 11) ** 2)));
  bins[0] = 3700;
  bins[63] = 5500;
  const sum = bins.reduce((a, b) => a + b);
  return bins.map((count) => count / sum);
}
