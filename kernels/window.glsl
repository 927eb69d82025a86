// SPDX-License-Identifier: Apache-2.0
// How threads share out windows, lines and pixels; included by the kernels that work on chip.
//
// A team of THREADS scores one window; small windows share a workgroup. A line is a pair of columns
// (first pass) or of rows (second pass), kept in registers as N vec2, SPLIT threads with POINTS
// each. A window has N/2 lines. Where they all are on chip at once there is one tile of LINES =
// N/2 and passes meet in shared memory; larger windows go tile by tile and meet in the scratch
// buffer.
#include "args.h"

layout(local_size_x_id = FATHOM_WORKGROUP) in;
layout(constant_id = FATHOM_N) const int N = 64;
layout(constant_id = FATHOM_POINTS) const int POINTS = 64;
layout(constant_id = FATHOM_LINES) const int LINES = 32;
layout(constant_id = FATHOM_TEAMS) const int TEAMS = 1;
layout(constant_id = FATHOM_PADDED) const bool PADDED = false;
layout(constant_id = FATHOM_BYTES) const int BYTES = 1;
layout(constant_id = FATHOM_POWER) const bool POWER = false;
layout(constant_id = FATHOM_WANTED) const int WANTED = FATHOM_SCORE;
layout(constant_id = FATHOM_RINGS) const int RINGS = 0;

const int SPLIT = N / POINTS;
const int THREADS = LINES * SPLIT;
const int TILES = N / 2 / LINES;
const int PITCH = PADDED ? LINES + 1 : LINES;
const int EXCHANGE = N * PITCH;  // numbers of a pool that one team exchanges at once

layout(push_constant) uniform Args { ScoreArgs args; };
layout(binding = FATHOM_BINDING_FRAME) readonly buffer Frame { uint frame_words[]; };
layout(binding = FATHOM_BINDING_RESULTS) writeonly buffer Scores { uvec2 scores[]; };

int team() { return int(gl_LocalInvocationID.x) / THREADS; }
int member() { return int(gl_LocalInvocationID.x) % THREADS; }

// The window of this team; teams beyond the last do its work again and keep it to themselves.
uint window_index() {
  const uint window = gl_WorkGroupID.x * TEAMS + team();
  return args.first_window + min(window, args.windows - 1);
}
uint origin_of(uint window) { return frame_words[window]; }
bool window_is_ours() { return gl_WorkGroupID.x * TEAMS + team() < args.windows; }

// Neighbouring threads have neighbouring lines, so that they read neighbouring pixels.
int line_of_tile() { return member() % LINES; }
int part_of_line() { return member() / LINES; }

// Rows start at whole words, so that a column's pixels lie at the same place of theirs.
struct Column {
  uint word;
  int shift;
};
Column column_at(uint origin, int x) {
  const uint byte = origin + uint(x * BYTES);
  return Column(byte / 4, int(byte % 4) * 8);
}
uint pixel(Column column, int y) {
  const uint word = frame_words[column.word + uint(y) * args.stride_words];
  return word >> column.shift & (BYTES == 1 ? 0xffu : 0xffffu);  // a field's length costs more
}

// pixel - level for whole levels, exactly and cheaper than by a conversion: above 2^23 the bits of a
// float count in ones.
float level_above(uint pixel, uint level) {
  return uintBitsToFloat(0x4b000000u | pixel) - (8388608.0 + float(level));
}

int reversed_bits(int value, int count) {
  return count == 1 ? 0 : int(bitfieldReverse(uint(value)) >> (32 - findMSB(uint(count))));
}

// Where value `row` of line `column` lies in a pool, so that neither the threads of neighbouring
// columns nor those of neighbouring rows meet in one bank: padded, where every offset is a constant,
// or turned, where there is no room for that.
int pool_at(int row, int column) {
  return row * PITCH + (PADDED ? column : column ^ (row % LINES));
}

// Where row v of line l lies in the workgroup's part of the scratch buffer.
int scratch_at(int v, int l) {
  return FATHOM_TABLE_BYTES(N) / 8 + (int(gl_WorkGroupID.x) * N + v) * (N / 2) + l;
}

// All columns of the window have been left in the scratch buffer.
void pass_on() {
  if (TILES > 1) {
    memoryBarrierBuffer();
    barrier();
  }
}
