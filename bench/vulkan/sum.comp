// SPDX-License-Identifier: Apache-2.0
// Weighs and sums up the magnitudes of a window's half plane. One workgroup a window.
#version 450
layout(local_size_x = 256) in;
layout(constant_id = 0) const uint N = 8;
layout(binding = 0) readonly buffer HalfPlanes { vec2 z[]; };
layout(binding = 1) readonly buffer Weights { float weights[]; };
layout(binding = 2) writeonly buffer Scores { float scores[]; };
shared float sums[256];

void main() {
  const uint count = N * (N / 2 + 1), window = gl_WorkGroupID.x, me = gl_LocalInvocationID.x;
  float sum = 0;
  for (uint i = me; i < count; i += 256) sum += weights[i] * length(z[window * count + i]);
  sums[me] = sum;
  for (uint left = 128; left > 0; left /= 2) {
    barrier();
    if (me < left) sums[me] += sums[me + left];
  }
  if (me == 0) scores[window] = sums[0];
}
