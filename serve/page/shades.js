// SPDX-License-Identifier: Apache-2.0
// Shades from dark to bright that colour-blind people tell apart, and that grey printing keeps in
// order: viridis, at the nine places of mapping/colour_map.cpp, so that a map on the page has the
// colours of depth.png (S. van der Walt and N. Smith, matplotlib, CC0).

const kPlaces = [
  [68, 1, 84], [71, 45, 123], [59, 82, 139], [44, 114, 142], [33, 145, 140],
  [40, 174, 128], [94, 201, 98], [173, 220, 48], [253, 231, 37],
];

/** part: 0..1. Red, green, blue and opaque, 0..255. */
export function shade(part) {
  const place = Math.min(Math.max(part, 0), 1) * (kPlaces.length - 1);
  const i = Math.min(Math.floor(place), kPlaces.length - 2), t = place - i;
  const mixed = [0, 1, 2].map((c) => Math.round(kPlaces[i][c] + t * (kPlaces[i + 1][c] - kPlaces[i][c])));
  return [...mixed, 255];
}

/** The 256 shades of a byte, each as one number of an image's bytes, which is quicker to set. */
const kShades = new Uint32Array(Uint8Array.from(
  Array.from({ length: 256 }, (_, value) => shade(value / 255)).flat()).buffer);

/** Colours the pixels of an image by bytes. */
export function shadeBytes(image, bytes) {
  const pixels = new Uint32Array(image.data.buffer);
  for (let i = 0; i < bytes.length; ++i) pixels[i] = kShades[bytes[i]];
}
