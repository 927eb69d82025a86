#version 450
// SPDX-License-Identifier: Apache-2.0
// Focus quality in some 46 bits, as plain as it gets: for windows that fft.comp does not trust its
// own single precision with, for bands, which may leave out nearly all that a picture holds, for
// Walsh transforms under a taper, and for cosine transforms.
//
// A workgroup takes one window after the other through its own N x N numbers of the scratch
// buffer: rows, columns, moment. Butterflies leave coefficients at positions of their own (reversed
// bits, or natural order); the table of lever arms knows them.
//
// A cosine transform is a Fourier transform of the samples in another order, the even ones upward
// and then the odd ones downward, turned by w^k = exp(-i pi k/(2 N)) (Makhoul 1980). In two dimensions
// 2 C(i, j) = Re w^i (w^j V(i, j) + w^-j V(i, -j)); its coefficients have no position but their index.
#extension GL_GOOGLE_include_directive : require
#include "args.h"
#include "double_float.glsl"

layout(local_size_x_id = FATHOM_WORKGROUP) in;
layout(constant_id = FATHOM_N) const int N = 64;
layout(constant_id = FATHOM_POWER) const bool POWER = false;
layout(constant_id = FATHOM_BANDED) const bool BANDED = false;
layout(constant_id = FATHOM_IS_WALSH) const bool IS_WALSH = false;
layout(constant_id = FATHOM_WANTED) const int WANTED = FATHOM_SCORE;
layout(constant_id = FATHOM_RINGS) const int RINGS = 0;
layout(constant_id = FATHOM_LESS_MEAN) const bool LESS_MEAN = false;
layout(constant_id = FATHOM_IS_COSINE) const bool IS_COSINE = false;
layout(constant_id = FATHOM_ENTROPY) const bool ENTROPY = false;

layout(push_constant) uniform Args { ScoreArgs args; };
layout(binding = FATHOM_BINDING_FRAME) readonly buffer Frame { uint frame_words[]; };
layout(binding = FATHOM_BINDING_RESULTS) writeonly buffer Scores { uvec2 scores[]; };
layout(binding = FATHOM_BINDING_RESULTS) writeonly buffer Values { uint values[]; };  // [window][ring]
// vec2[N] taper; vec4[N/2] roots of unity exp(-2 pi i k/N); float[N] squared lever arms by
// position; of cosine transforms vec4[N] e(k) cos(pi k/(2 N)) and the sine of that, float[N] the
// position of frequency k; of rings: vec2 1 / SUM w(x) w(y), then bytes [row][column], by position,
// which slot the coefficient goes to.
layout(binding = FATHOM_BINDING_WORK) readonly buffer Tables { float tables[]; };
layout(binding = FATHOM_BINDING_WORK) readonly buffer RingTable { uint ring_words[]; };
layout(binding = FATHOM_BINDING_WORK) coherent buffer Scratch { vec4 scratch[]; };  // re, im
// By position.
layout(binding = FATHOM_BINDING_RESULTS) writeonly buffer Spectrum { vec4 spectrum[]; };
layout(binding = FATHOM_BINDING_DOUBTFUL) readonly buffer Doubtful {
  uint doubtful_count;
  uint doubtful[];
};

shared vec2 sums[gl_WorkGroupSize.x];
// [ring][thread], and after the rings what lies in none.
shared vec2 slots[RINGS > 0 ? (RINGS + 1) * int(gl_WorkGroupSize.x) : 1];

const int RING_TABLE = (IS_COSINE ? 10 : 5) * N + 2;
const bool IS_REAL = IS_WALSH || IS_COSINE;

int id() { return int(gl_LocalInvocationID.x); }
int members() { return int(gl_WorkGroupSize.x); }
int at(int row, int column) {
  return FATHOM_TABLE_BYTES(N) / 16 + (int(gl_WorkGroupID.x) * N + row) * N + column;
}
vec2 table2(int k) { return vec2(tables[k], tables[k + 1]); }
vec2 taper(int x) { return table2(2 * x); }
vec4 root(int k) { return vec4(table2(2 * N + 4 * k), table2(2 * N + 4 * k + 2)); }
float arm(int position) { return tables[4 * N + position]; }
vec4 turn(int k) { return vec4(table2(5 * N + 4 * k), table2(5 * N + 4 * k + 2)); }
int position_of(int k) { return int(tables[9 * N + k]); }

// Which pixel of a line is its sample k.
int sample_at(int k) {
  if (!IS_COSINE) return k;
  return k < N / 2 ? 2 * k : 2 * (N - k) - 1;
}

void everybody() {
  memoryBarrierBuffer();
  barrier();
}

float pixel(uint origin, int x, int y) {
  const int bits = 8 * int(args.bytes_per_pixel);
  const uint byte = origin + 4 * uint(y) * args.stride_words + uint(x) * args.bytes_per_pixel;
  return float(bitfieldExtract(frame_words[byte / 4], int(byte % 4) * 8, bits));
}

vec2 sum_of_all(vec2 value) {
  barrier();
  sums[id()] = value;
  for (int half_way = members() / 2; half_way > 0; half_way /= 2) {
    barrier();
    if (id() < half_way) sums[id()] = df_add(sums[id()], sums[id() + half_way]);
  }
  barrier();
  return sums[0];
}

// SUM w w f / SUM w w.
vec2 weighted_mean(uint origin) {
  vec2 sum = vec2(0);
  for (int e = id(); e < N * N; e += members()) {
    const int x = e % N, y = e / N;
    sum = df_add(sum, df_mul(df_mul(taper(x), taper(y)), vec2(pixel(origin, x, y), 0)));
  }
  return df_mul(sum_of_all(sum), table2(RING_TABLE - 2));
}

// The tapered pixels; twice them before the FFT, as in fft.comp. Gives the sum of their squares, of
// an entropy, for this thread.
vec2 load(uint origin) {
  vec2 squares = vec2(0);
  const vec2 mean = LESS_MEAN ? weighted_mean(origin) : vec2(0);
  for (int e = id(); e < N * N; e += members()) {
    const int x = e % N, y = e / N;
    vec2 f = vec2(pixel(origin, sample_at(x), sample_at(y)), 0);
    if (ENTROPY) squares = df_add(squares, two_product(f.x, f.x));
    if (LESS_MEAN) f = df_add(f, -mean);
    const vec2 tapered = df_mul(df_mul(taper(x), taper(y)), f);
    scratch[at(y, x)] = vec4(IS_REAL ? tapered : 2 * tapered, 0, 0);
  }
  everybody();
  return squares;
}

vec4 times(vec4 a, vec4 b) {
  return vec4(df_add(df_mul(a.xy, b.xy), -df_mul(a.zw, b.zw)),
              df_add(df_mul(a.xy, b.zw), df_mul(a.zw, b.xy)));
}

// One stage of all rows (or columns) by decimation in frequency.
void stage(int span, bool along_columns) {
  for (int b = id(); b < N * N / 2; b += members()) {
    const int line = b / (N / 2), i = b % (N / 2), r = i % span;
    const int first = (i / span) * 2 * span + r, second = first + span;
    const int p = along_columns ? at(first, line) : at(line, first);
    const int q = along_columns ? at(second, line) : at(line, second);
    const vec4 x = scratch[p], y = scratch[q];
    const vec4 difference = vec4(df_add(x.xy, -y.xy), df_add(x.zw, -y.zw));
    scratch[p] = vec4(df_add(x.xy, y.xy), df_add(x.zw, y.zw));
    scratch[q] = IS_WALSH || r == 0 ? difference : times(difference, root(r * (N / 2 / span)));
  }
  everybody();
}

// The coefficient at a position, of a cosine transform at an index.
vec4 coefficient_at(int row, int column) {
  if (!IS_COSINE) return scratch[at(row, column)];
  const vec4 i = turn(row), j = turn(column);
  const int line = position_of(row);
  const vec4 v = scratch[at(line, position_of(column))];
  const vec4 u = scratch[at(line, position_of((N - column) % N))];
  const vec2 re = df_add(df_mul(j.xy, df_add(v.xy, u.xy)), df_mul(j.zw, df_add(v.zw, -u.zw)));
  const vec2 im = df_add(df_mul(j.xy, df_add(v.zw, u.zw)), df_mul(j.zw, df_add(u.xy, -v.xy)));
  return vec4(0.5 * df_add(df_mul(i.xy, re), df_mul(i.zw, im)), 0, 0);
}

// |f| or |f|^2.
vec2 mass(vec4 f) {
  if (IS_COSINE && !POWER) return f.x < 0 ? -f.xy : f.xy;
  const vec2 square = df_add(df_mul(f.xy, f.xy), df_mul(f.zw, f.zw));
  return POWER ? square : df_sqrt(square);
}

// Whether a coefficient counts, so far from zero frequency.
bool is_in_band(float squared_radius) {
  return !BANDED ||
         (uint(squared_radius) > args.band_above && uint(squared_radius) <= args.band_to);
}

// SUM m r^2 over this thread's coefficients; of the Fourier plane one half counts.
vec2 moment() {
  vec2 sum = vec2(0);
  for (int e = id(); e < N * N; e += members()) {
    const int row = e / N, column = e % N;
    const float squared_radius = arm(row) + arm(column);
    const vec4 f = coefficient_at(row, column);
    if (WANTED == FATHOM_COEFFICIENTS) spectrum[e] = f;
    if (!is_in_band(squared_radius)) continue;
    sum = df_add(sum, df_mul(mass(f), vec2(squared_radius, 0)));
  }
  return IS_REAL ? sum : 0.5 * sum;
}

// SUM p log2 1/p over this thread's coefficients, p = m/L; L follows from the pixels (Parseval).
vec2 entropy(vec2 squares) {
  if (squares.x == 0) return vec2(0);  // all black
  const vec2 inverse = df_inverse(N * df_sqrt(squares));
  vec2 sum = vec2(0);
  for (int e = id(); e < N * N; e += members()) {
    const int row = e / N, column = e % N;
    const float squared_radius = arm(row) + arm(column);
    if (squared_radius == 0 || !is_in_band(squared_radius)) continue;
    const vec2 p = df_mul(mass(coefficient_at(row, column)), inverse);
    if (p.x > 1e-30) sum = df_add(sum, vec2(-p.x * df_log2(p), 0));
  }
  return sum;
}

// SUM m in each ring; the sums of the first thread's slots are those of all.
void sum_rings() {
  for (int ring = 0; ring <= RINGS; ++ring) slots[ring * members() + id()] = vec2(0);
  for (int e = id(); e < N * N; e += members()) {
    const int ring = int(ring_words[RING_TABLE + e / 4] >> (8 * (e % 4)) & 0xffu);
    const int slot = ring * members() + id();
    slots[slot] = df_add(slots[slot], mass(coefficient_at(e / N, e % N)));
  }
  for (int half_way = members() / 2; half_way > 0; half_way /= 2) {
    barrier();
    for (int i = id(); i < RINGS * half_way; i += members()) {
      const int slot = i / half_way * members() + i % half_way;
      slots[slot] = df_add(slots[slot], slots[slot + half_way]);
    }
  }
  barrier();
}

void leave_rings(uint window) {
  sum_rings();
  for (int ring = id(); ring < RINGS; ring += members()) {
    const vec2 sum = slots[ring * members()];
    values[window * RINGS + ring] = floatBitsToUint(IS_REAL ? sum.x : 0.5 * sum.x);
  }
}

void main() {
  const uint count = args.windows > 0 ? args.windows : doubtful_count;
  for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
    const uint window = args.windows > 0 ? args.first_window + i : doubtful[i];
    const vec2 squares = load(frame_words[window]);
    for (int span = N / 2; span > 0; span /= 2) stage(span, false);
    for (int span = N / 2; span > 0; span /= 2) stage(span, true);
    if (RINGS > 0) {
      leave_rings(window);
      continue;
    }
    const vec2 score = sum_of_all(ENTROPY ? entropy(sum_of_all(squares)) : moment());
    if (id() == 0 && WANTED == FATHOM_SCORE) scores[window] = floatBitsToUint(score);
  }
}
