#version 450
// SPDX-License-Identifier: Apache-2.0
// Focus quality by the Walsh-Hadamard transform without a taper, from pixels to one number per
// window, or to one for each of its RINGS, to the last bit (thesis eq. 5-2). What is computed is N^2 W
// in natural (Hadamard) order; the other orders hold the same coefficients, so a table of lever arms is all that they are.
//
// Compiled twice: in float, which is exact up to 2^24 and twice as fast as integers on many GPUs,
// for 8-bit pixels and N <= 256 (|W| <= 128 N^2 = 2^23); in 32-bit integers for the rest. What
// would not fit there (16-bit pixels, N = 512) is split before its last stages (`PLANES`).
//
// The middle of the pixels' range is subtracted: it is the coefficient (0, 0) alone that it shows
// in, which no lever arm reaches and no ring holds.
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

// uint[N]: squared lever arm of the coefficient at each natural position. Of rings: bytes [N][N],
// which slot the coefficient at two positions goes to.
layout(binding = FATHOM_BINDING_WORK) readonly buffer Tables { uint arms[]; };
layout(binding = FATHOM_BINDING_WORK) coherent buffer Scratch { Pair scratch[]; };
// 2^12 x + y.
layout(binding = FATHOM_BINDING_RESULTS) writeonly buffer Spectrum { ivec2 spectrum[]; };

const int RING_TABLE = N;
const int RING_SLOTS = RINGS + 1;  // the last: what lies in no ring
const int RING_SLOTS_START = 0;
const int RING_LIMBS_START = RING_SLOTS * THREADS;  // of the team's sums, three for each ring
const int SUMMED = RING_LIMBS_START + 3 * RINGS;
const int POOL = RINGS > 0 && SUMMED > EXCHANGE ? SUMMED : EXCHANGE;  // a team's part
shared uint pool[POOL * TEAMS];

float from_pool(int at) { return uintBitsToFloat(pool[at]); }
void to_pool(int at, float number) { pool[at] = floatBitsToUint(number); }
#include "rings.glsl"

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
      pool[base + (p * SPLIT + part) * PITCH + line] = bits_of(z[p][c]);
    }
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      z[p][c] = number_of(pool[base + position(p) * PITCH + line]);
    }
  }
  transform_registers(SPLIT);
}

// A pixel less the middle of the range.
Number centred(uint pixel) {
#ifdef FATHOM_IN_FLOAT
  return level_above(pixel, 1u << (8 * BYTES - 1));
#else
  return int(pixel) - (1 << (8 * BYTES - 1));
#endif
}

// Columns l and l + N/2, and already the one stage of the rows that joins them.
void load_columns(uint origin, int l) {
  const Column left = column_at(origin, l), right = column_at(origin, l + N / 2);
  [[unroll]] for (int a = 0; a < POINTS; ++a) {
    const int y = part_of_line() + SPLIT * a;
    const Number f = centred(pixel(left, y)), g = centred(pixel(right, y));
    z[a] = Pair(f + g, f - g);
  }
}

// Gives up the line of columns; takes the rows v (registers below POINTS/2) and v + N/2 (the rest)
// instead, of the lines l = part + SPLIT a.
void take_rows_on_chip(int v) {
  const int line = line_of_tile(), base = team() * POOL;
  [[unroll]] for (int c = 0; c < 2; ++c) {
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      pool[base + pool_at(position(p), line)] = bits_of(z[p][c]);
    }
    barrier();
    [[unroll]] for (int a = 0; a < POINTS / 2; ++a) {
      const int l = part_of_line() + SPLIT * a;
      z[a][c] = number_of(pool[base + pool_at(v, l)]);
      z[a + POINTS / 2][c] = number_of(pool[base + pool_at(v + N / 2, l)]);
    }
  }
}

void leave_columns(int l) {
  [[unroll]] for (int p = 0; p < POINTS; ++p) scratch[scratch_at(position(p), l)] = z[p];
}

// Rows v and v + N/2, of two planes the one: value = 2^12 upper + lower.
void take_rows_from_scratch(int v, int plane) {
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

// A sum of magnitudes |W|, in as few words as hold it. Above 2^23 the bits of a float count in ones,
// which is cheaper than a conversion: in float every term brings the bits of 2^23 with it, and
// without_bits takes them away from the sum.
#ifdef FATHOM_IN_FLOAT
#define Mass uint
const int LIMBS = 1;
const Mass NOTHING = 0x4b000000u;  // of one term

Mass magnitude(int p, int c) { return floatBitsToUint(abs(z[p][c]) + 8388608.0); }
Mass without_bits(Mass sum, int terms) { return sum - uint(terms) * NOTHING; }
float as_float(Mass term) { return uintBitsToFloat(term) - 8388608.0; }
uint limb(Mass mass, int i) { return mass; }
void add_to_limb(inout Mass mass, int i, uint more) { mass += more; }
#else
#define Mass uvec2  // low + 2^16 high
const int LIMBS = 2;
const Mass NOTHING = uvec2(0);

Mass magnitude(int p, int c) {
  if (PLANES == 1) {
    const uint m = uint(abs(z[p][c]));
    return Mass(m & 0xffffu, m >> 16);
  }
  int x = upper[p][c] + (z[p][c] >> 12), y = z[p][c] & 0xfff;  // 2^12 x + y, 0 <= y < 2^12
  if (x < 0) {
    x = y == 0 ? -x : -x - 1;
    y = -y & 0xfff;
  }
  return Mass((uint(x & 0xf) << 12) + uint(y), uint(x >> 4));
}
Mass without_bits(Mass sum, int terms) { return sum; }
float as_float(Mass term) { return float(term.y) * 65536.0 + float(term.x); }
uint limb(Mass mass, int i) { return mass[i]; }
void add_to_limb(inout Mass mass, int i, uint more) { mass[i] += more; }
#endif

bool in_band(uint squared_radius) {
  return !BANDED || (args.band_above < squared_radius && squared_radius <= args.band_to);
}

Mass columns[POINTS / 2][2];  // SUM |W| of each column over this thread's two rows
uvec2 total;                  // 64 bits: low word, high word
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

void add_moment(uint arm, uint mass) { total = add(total, product(arm, mass)); }
void add_moment(uint arm, uvec2 mass) {
  const uvec2 high = product(arm, mass.y);
  total = add(total, product(arm, mass.x));
  total = add(total, uvec2(high.x << 16, (high.y << 16) + (high.x >> 16)));
}

// |W| of row i, register p, part c, if it counts.
Mass term(int i, int p, int c, uint row_arm) {
  const int j = position(p % (POINTS / 2)) + c * N / 2;
  if (WANTED == FATHOM_COEFFICIENTS) {
    spectrum[i * N + j] = ivec2(PLANES == 2 ? int(upper[p][c]) : 0, int(z[p][c]));
  }
  const Mass m = !BANDED || in_band(row_arm + arms[j]) ? magnitude(p, c) : NOTHING;
  if (POWER) power_total += as_float(m) * as_float(m) * float(row_arm + arms[j]);
  return m;
}

// Rows v and v + N/2 of natural order. I_z = I_x + I_y: rows at once, columns gathered.
void add_rows(int v) {
  const uint upper_arm = arms[v], lower_arm = arms[v + N / 2];
  Mass upper_row = Mass(0), lower_row = Mass(0);
  [[unroll]] for (int p = 0; p < POINTS / 2; ++p) {
    [[unroll]] for (int c = 0; c < 2; ++c) {
      const Mass m = term(v, p, c, upper_arm), n = term(v + N / 2, p + POINTS / 2, c, lower_arm);
      upper_row += m;
      lower_row += n;
      columns[p][c] = m + n;
    }
  }
  if (POWER) return;
  add_moment(upper_arm, without_bits(upper_row, POINTS));
  add_moment(lower_arm, without_bits(lower_row, POINTS));
}

// Every thread has sums over its two rows of the columns at its positions. Now it adds up, for the
// columns of its line, LINES/SPLIT threads' sums.
void add_columns() {
  const int line = line_of_tile(), base = team() * POOL;
  Mass sums[N / LINES];
  [[unroll]] for (int q = 0; q < N / LINES; ++q) sums[q] = Mass(0);
  [[unroll]] for (int i = 0; i < LIMBS; ++i) {
    barrier();
    [[unroll]] for (int p = 0; p < POINTS / 2; ++p) {
      [[unroll]] for (int c = 0; c < 2; ++c) {
        pool[base + pool_at(position(p) + c * N / 2, line)] = limb(columns[p][c], i);
      }
    }
    barrier();
    [[unroll]] for (int q = 0; q < N / LINES; ++q) {
      [[unroll]] for (int a = 0; a < LINES / SPLIT; ++a) {
        const int other = part_of_line() + SPLIT * a;
        add_to_limb(sums[q], i, pool[base + pool_at(line + LINES * q, other)]);
      }
    }
  }
  [[unroll]] for (int q = 0; q < N / LINES; ++q) {
    add_moment(arms[line + LINES * q], without_bits(sums[q], 2 * LINES / SPLIT));
  }
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

#include "walsh_rings.glsl"

// What a tile of rows adds to the window's sums.
void add_tile(int v) {
  if (RINGS > 0) {
    add_tile_to_rings(v);
  } else {
    add_rows(v);
    if (!POWER) add_columns();
  }
}

// All lines are on chip at once. Written out, because a loop over the two passes makes compilers keep
// what both have in common in registers that there are not.
void score_on_chip(uint origin) {
  const int line = line_of_tile();
  load_columns(origin, line);
  transform_line(true);
  take_rows_on_chip(line);
  transform_line(false);
  add_tile(line);
}

// Columns, tile by tile, then rows; those of two planes one after the other.
void score_in_tiles(uint origin) {
  for (int step = 0; step < 2 * TILES; ++step) {
    const bool is_columns = step < TILES;
    const int line = step % TILES * LINES + line_of_tile();
    if (step == TILES) pass_on();
    const int planes = is_columns ? 1 : PLANES;
    for (int plane = 0; plane < planes; ++plane) {
      if (is_columns) {
        load_columns(origin, line);
      } else {
        take_rows_from_scratch(line, plane);
      }
      transform_line(is_columns);
      if (plane + 1 < planes) {
        [[unroll]] for (int p = 0; p < POINTS; ++p) upper[p] = z[p];
      }
    }
    if (is_columns) {
      leave_columns(line);
    } else {
      add_tile(line);
    }
  }
}

void main() {
  const uint window = window_index(), origin = origin_of(window);
  total = uvec2(0);
  power_total = 0;
  [[unroll]] for (int i = 0; i < SUMS_OF_MEMBER; ++i) ring_sums[i] = uvec2(0);
  if (TILES == 1) {
    score_on_chip(origin);
  } else {
    score_in_tiles(origin);
  }
  if (RINGS > 0) {
    leave_rings(window);
    return;
  }
  const uvec2 sum = team_sum();
  if (WANTED == FATHOM_SCORE && member() == 0 && window_is_ours()) scores[window] = sum;
}
