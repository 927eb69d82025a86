// SPDX-License-Identifier: Apache-2.0
// 8-bit pixels of windows, tapered, to rows of N floats in the place of N/2 + 1 complex numbers. One
// invocation a pixel.
#version 450
layout(local_size_x = 256) in;
layout(constant_id = 0) const uint N = 8;
layout(push_constant) uniform Push {
  uint windows;
  uint stride;
};
layout(binding = 0) readonly buffer Frame { uint pixels[]; };  // four to a word
layout(binding = 1) readonly buffer Origins { uint origins[]; };
layout(binding = 2) readonly buffer Taper { float taper[]; };
layout(binding = 3) writeonly buffer Rows { float rows[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= windows * N * N) return;
  const uint window = i / (N * N), y = i / N % N, x = i % N;
  const uint at = origins[window] + y * stride + x;
  const uint pixel = pixels[at / 4] >> 8 * (at % 4) & 255;
  rows[(window * N + y) * (N + 2) + x] = float(pixel) * (taper[y] * taper[x]);
}
