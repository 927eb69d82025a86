#version 450
// SPDX-License-Identifier: Apache-2.0
// Focus quality by the Walsh-Hadamard transform without a taper, from pixels to one number per
// window, to the last bit (thesis eq. 5-2). What is computed is N^2 W in natural (Hadamard) order;
// the other orders hold the same coefficients, so a table of lever arms is all that they are.
//
// Compiled twice: in float, which is exact up to 2^24 and twice as fast as integers on many GPUs,
// for 8-bit pixels and N <= 256 (|W| <= 128 N^2 = 2^23); in 32-bit integers for the rest. What
// would not fit there (16-bit pixels, N = 512) is split before its last stages (`PLANES`).
//
// The middle of the pixels' range is subtracted: it is the coefficient (0, 0) alone that it shows
// in, which no lever arm reaches.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "window.glsl"

layout(constant_id = FATHOM_BANDED) const bool BANDED = false;
layout(constant_id = FATHOM_PLANES) const int PLANES = 1;

#ifdef FATHOM_IN_FLOAT
#define Number float
#define Pair vec2
#define bits_of floatBitsToUint
#define number_of uintBitsToFloat
#else
#define Number int
#define Pair ivec2
#define bits_of uint
#define number_of int
#endif

// uint[N]: squared lever arm of the coefficient at each natural position.
layout(binding = FATHOM_TABLES) readonly buffer Tables { uint arms[]; };
layout(binding = FATHOM_SCRATCH) coherent buffer Scratch { Pair scratch[]; };
layout(binding = FATHOM_SPECTRUM) writeonly buffer Spectrum { ivec2 spectrum[]; };  // 2^12 x + y

shared uint pool[POOL * TEAMS];

Pair z[POINTS];      // this thread's part of its line
Pair upper[POINTS];  // of PLANES = 2 the one that counts 2^12

void butterfly(int first, int second) {
  const Pair sum = z[first] + z[second], difference = z[first] - z[second];
  z[first] = sum;
  z[second] = difference;
}

// Transforms each run of `points` registers.
void transform_registers(int points) {
  [[unroll]] for (int span = 1; span < points; span *= 2) {
    [[unroll]] for (int i = 0; i < POINTS / 2; ++i) {
      const int first = (i / span) * 2 * span + i % span;
      butterfly(first, first + span);
    }
  }
}

// The position along its line of the coefficient that register p holds after transform_line; those
// of a run of half a line count from its start.
int position(int p) {
  return (part_of_line() + SPLIT * (p / SPLIT)) * SPLIT + p % SPLIT;
}

// The transform of a line, or of its halves alone, whose sample part + SPLIT a is register a: over a,
// then, where threads share the line, over the parts.
void transform_line(bool is_whole) {
  transform_registers(POINTS / 2);
  if (is_whole) {
    [[unroll]] for (int i = 0; i < POINTS / 2; ++i) butterfly(i, i + POINTS / 2);
  }
  if (SPLIT == 1) return;
  const int line = line_of_tile(), part = part_of_line(), base = team() * POOL;
  [[unroll]] for (int c = 0; c < 2; ++c) {
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      pool[base + (p * SPLIT + part) * LINES + line] = bits_of(z[p][c]);
    }
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      z[p][c] = number_of(pool[base + position(p) * LINES + line]);
    }
  }
  transform_registers(SPLIT);
}

// Columns l and l + N/2, and already the one stage of the rows that joins them.
void load_columns(uint origin, int l) {
  const Column left = column_at(origin, l), right = column_at(origin, l + N / 2);
  const Number middle = Number(1u << (8 * args.bytes_per_pixel - 1));
  [[unroll]] for (int a = 0; a < POINTS; ++a) {
    const int y = part_of_line() + SPLIT * a;
    const Number f = Number(pixel(left, y)), g = Number(pixel(right, y));
    z[a] = Pair(f + g - 2 * middle, f - g);
  }
}

int scratch_at(int i, int l) { return (int(gl_WorkGroupID.x) * N + i) * (N / 2) + l; }

// Gives up the line of columns; takes the rows v (registers below POINTS/2) and v + N/2 (the rest)
// instead, of the lines l = part + SPLIT a.
void take_rows_on_chip(int v) {
  const int line = line_of_tile(), base = team() * POOL;
  [[unroll]] for (int c = 0; c < 2; ++c) {
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      pool[base + turned(position(p), line)] = bits_of(z[p][c]);
    }
    barrier();
    [[unroll]] for (int a = 0; a < POINTS / 2; ++a) {
      const int l = part_of_line() + SPLIT * a;
      z[a][c] = number_of(pool[base + turned(v, l)]);
      z[a + POINTS / 2][c] = number_of(pool[base + turned(v + N / 2, l)]);
    }
  }
}

void pass_on() {
  if (TILES > 1) {
    memoryBarrierBuffer();
    barrier();
  }
}

void leave_columns(int l) {
  [[unroll]] for (int p = 0; p < POINTS; ++p) scratch[scratch_at(position(p), l)] = z[p];
}

// Rows v and v + N/2, of two planes the one: value = 2^12 upper + lower.
void take_rows(int v, int plane) {
  if (TILES == 1) {
    take_rows_on_chip(v);
    return;
  }
  [[unroll]] for (int a = 0; a < POINTS / 2; ++a) {
    const int l = part_of_line() + SPLIT * a;
    z[a] = scratch[scratch_at(v, l)];
    z[a + POINTS / 2] = scratch[scratch_at(v + N / 2, l)];
  }
#ifndef FATHOM_IN_FLOAT
  if (PLANES == 1) return;
  [[unroll]] for (int p = 0; p < POINTS; ++p) z[p] = plane == 0 ? z[p] >> 12 : z[p] & 0xfff;
#endif
}

#ifdef FATHOM_IN_FLOAT
const int LIMBS = 1;
#else
const int LIMBS = 2;
#endif

// |W| of register p as low + 2^16 high, low < 2^16 unless it is all there is.
uvec2 magnitude(int p, int c) {
#ifdef FATHOM_IN_FLOAT
  // Above 2^23 the bits of a float count in ones: cheaper than a conversion.
  return uvec2(floatBitsToUint(abs(z[p][c]) + 8388608.0) - 0x4b000000u, 0);
#else
  if (PLANES == 1) {
    const uint m = uint(abs(z[p][c]));
    return uvec2(m & 0xffffu, m >> 16);
  }
  int x = upper[p][c] + (z[p][c] >> 12), y = z[p][c] & 0xfff;  // 2^12 x + y, 0 <= y < 2^12
  if (x < 0) {
    x = y == 0 ? -x : -x - 1;
    y = -y & 0xfff;
  }
  return uvec2((uint(x & 0xf) << 12) + uint(y), uint(x >> 4));
#endif
}

float as_float(uvec2 m) { return float(m.y) * 65536.0 + float(m.x); }

bool in_band(uint squared_radius) {
  return !BANDED || (args.band_above < squared_radius && squared_radius <= args.band_to);
}

uvec2 columns[POINTS / 2][2];  // SUM |W| of each column over this thread's rows, as magnitude
uvec2 total;                   // 64 bits: low word, high word
float power_total;

uvec2 add(uvec2 a, uvec2 b) {
  uint carry;
  const uint low = uaddCarry(a.x, b.x, carry);
  return uvec2(low, a.y + b.y + carry);
}

uvec2 product(uint a, uint b) {
  uvec2 result;
  umulExtended(a, b, result.y, result.x);
  return result;
}

void add_moment(uint arm, uvec2 mass) {
  const uvec2 high = product(arm, mass.y);
  total = add(total, product(arm, mass.x));
  total = add(total, uvec2(high.x << 16, (high.y << 16) + (high.x >> 16)));
}

// Row v + N/2 half_plane of natural order. I_z = I_x + I_y: rows at once, columns gathered.
void add_row(int v, int half_plane) {
  const int i = v + half_plane * N / 2;
  const uint row_arm = arms[i];
  uvec2 row = uvec2(0);
  [[unroll]] for (int p = 0; p < POINTS / 2; ++p) {
    [[unroll]] for (int c = 0; c < 2; ++c) {
      const int q = p + half_plane * POINTS / 2, j = position(p) + c * N / 2;
      if (WANTED == FATHOM_COEFFICIENTS) {
        spectrum[i * N + j] = ivec2(PLANES == 2 ? int(upper[q][c]) : 0, int(z[q][c]));
      }
      uvec2 m = magnitude(q, c);
      if (BANDED && !in_band(row_arm + arms[j])) m = uvec2(0);
      if (POWER) {
        const float mass = as_float(m);
        power_total += mass * mass * float(row_arm + arms[j]);
      } else {
        row += m;
        columns[p][c] += m;
      }
    }
  }
  if (!POWER) add_moment(row_arm, row);
}

// Every thread has sums over its own rows of the columns at its positions. Now it adds up, for the
// columns of its line, LINES/SPLIT threads' sums.
void add_columns() {
  const int line = line_of_tile(), base = team() * POOL;
  uvec2 sums[N / LINES];
  [[unroll]] for (int q = 0; q < N / LINES; ++q) sums[q] = uvec2(0);
  [[unroll]] for (int limb = 0; limb < LIMBS; ++limb) {
    barrier();
    [[unroll]] for (int p = 0; p < POINTS / 2; ++p) {
      [[unroll]] for (int c = 0; c < 2; ++c) {
        pool[base + turned(position(p) + c * N / 2, line)] = columns[p][c][limb];
      }
    }
    barrier();
    [[unroll]] for (int q = 0; q < N / LINES; ++q) {
      for (int a = 0; a < LINES / SPLIT; ++a) {
        sums[q][limb] += pool[base + turned(line + LINES * q, part_of_line() + SPLIT * a)];
      }
    }
  }
  [[unroll]] for (int q = 0; q < N / LINES; ++q) add_moment(arms[line + LINES * q], sums[q]);
}

// The sum of the team's totals, for its first member.
uvec2 team_sum() {
  const int low = team() * POOL + member(), high = low + THREADS;
  barrier();
  pool[low] = POWER ? floatBitsToUint(power_total) : total.x;
  pool[high] = total.y;
  [[unroll]] for (int half_way = THREADS / 2; half_way > 0; half_way /= 2) {
    barrier();
    if (member() < half_way) {
      if (POWER) {
        pool[low] = floatBitsToUint(uintBitsToFloat(pool[low]) +
                                    uintBitsToFloat(pool[low + half_way]));
      } else {
        const uvec2 sum = add(uvec2(pool[low], pool[high]),
                              uvec2(pool[low + half_way], pool[high + half_way]));
        pool[low] = sum.x;
        pool[high] = sum.y;
      }
    }
  }
  barrier();
  return uvec2(pool[low], pool[high]);
}

void main() {
  const uint window = window_index(), origin = window_origins[window];
  total = uvec2(0);
  power_total = 0;
  [[unroll]] for (int p = 0; p < POINTS / 2; ++p) columns[p] = uvec2[2](uvec2(0), uvec2(0));
  for (int step = 0; step < 2 * TILES; ++step) {
    const bool is_columns = step < TILES;
    const int line = step % TILES * LINES + line_of_tile();
    if (step == TILES) pass_on();
    const int planes = is_columns ? 1 : PLANES;
    for (int plane = 0; plane < planes; ++plane) {
      if (is_columns) {
        load_columns(origin, line);
      } else {
        take_rows(line, plane);
      }
      transform_line(is_columns);
      if (plane + 1 < planes) {
        [[unroll]] for (int p = 0; p < POINTS; ++p) upper[p] = z[p];
      }
    }
    if (is_columns) {
      if (TILES > 1) leave_columns(line);
    } else {
      add_row(line, 0);
      add_row(line, 1);
    }
  }
  if (!POWER) add_columns();
  const uvec2 sum = team_sum();
  if (member() == 0 && window_is_ours()) scores[window] = sum;
}
