// SPDX-License-Identifier: Apache-2.0
// Windows as numbers: where they may lie, and what becomes of them when they are moved or resized.
// A window is {x, y, n}: left column, top row and side in pixels; n is a power of two.

export const kLeast = 8;
export const kMost = 512;

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** The largest side that a picture has room for. */
export function largest({ width, height }) {
  return Math.min(2 ** Math.floor(Math.log2(Math.min(width, height))), kMost);
}

/** The power of two next to a wanted side. */
export function nearestSide(wanted, camera) {
  const side = 2 ** Math.round(Math.log2(Math.max(wanted, 1)));
  return clamp(side, Math.min(kLeast, largest(camera)), largest(camera));
}

/** The window within the picture that is nearest to this one. */
export function within({ x, y, n }, camera) {
  return {
    x: clamp(Math.round(x), 0, camera.width - n),
    y: clamp(Math.round(y), 0, camera.height - n),
    n,
  };
}

export const moved = (window, dx, dy, camera) =>
  within({ ...window, x: window.x + dx, y: window.y + dy }, camera);

/** Centred on a point of the picture. */
export const centred = (window, x, y, camera) =>
  within({ ...window, x: x - window.n / 2, y: y - window.n / 2 }, camera);

/** With another side about the same centre. */
export function resized(window, side, camera) {
  const n = nearestSide(side, camera);
  return centred({ ...window, n }, window.x + window.n / 2, window.y + window.n / 2, camera);
}

/** As its lower right corner was dragged to a point: the upper left one stays where there is room. */
export function stretched(window, x, y, camera) {
  const n = nearestSide(Math.max(x - window.x, y - window.y), camera);
  return within({ ...window, n }, camera);
}

/** A new window, beside those that there are where there is room. */
export function another(windows, camera) {
  const last = windows.at(-1) ?? resized({ x: camera.width / 2, y: camera.height / 2, n: 0 }, 64, camera);
  const right = last.x + 2 * last.n <= camera.width;
  return within({ ...last, x: right ? last.x + last.n : 0, y: right ? last.y : last.y + last.n }, camera);
}
