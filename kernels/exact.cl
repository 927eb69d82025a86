// SPDX-License-Identifier: Apache-2.0
// Focus quality in some 46 bits, as plain as it gets: for windows that fft.cl does not trust its own
// single precision with, for bands, which may leave out nearly all that a picture holds, for
// Walsh transforms under a taper, and for cosine transforms (exact.comp says how).
//
// A workgroup takes one window after the other through its own N x N numbers of the scratch
// memory: rows, columns, moment. Butterflies leave coefficients at positions of their own (reversed
// bits, or natural order); the table of lever arms knows them.
#include "args.h"

#ifndef N  // for compilers that only check
#define WORKGROUP 128
#define N 64
#define POWER 0
#define BANDED 0
#define IS_WALSH 0
#define WANTED FATHOM_SCORE
#define RINGS 0
#define LESS_MEAN 0
#define IS_COSINE 0
#define ENTROPY 0
#endif
#define IS_REAL (IS_WALSH || IS_COSINE)
#include "double_float.clh"

// What a thread works with.
typedef struct {
  __global const float2* taper;  // [N]
  __global const float4* roots;  // [N/2]: exp(-2 pi i k/N)
  __global const float* arms;    // [N]: squared, by position
#if IS_COSINE
  __global const float4* turns;      // [N]: e(k) cos(pi k/(2 N)), and the sine
  __global const float* positions;   // [N]: of frequency k
#endif
  __global float4* plane;        // [N][N]: re, im
  __global float4* spectrum;     // [N][N], by position
  __local float2* sums;          // [WORKGROUP]
#if RINGS > 0
  __global const float2* unit;   // 1 / SUM w(x) w(y)
  __global const uchar* rings;   // [N][N], by position: which slot a coefficient goes to
  __local float2* slots;         // [RINGS + 1][WORKGROUP]; after the rings what lies in none
#endif
} Work;

static int id(void) { return (int)get_local_id(0); }

static void everybody(void) { barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE); }

static float2 sum_of_all(const Work* work, float2 value) {
  __local float2* const sums = work->sums;
  everybody();
  sums[id()] = value;
  for (int half_way = WORKGROUP / 2; half_way > 0; half_way /= 2) {
    everybody();
    if (id() < half_way) sums[id()] = df_add(sums[id()], sums[id() + half_way]);
  }
  everybody();
  return sums[0];
}

static float2 pixel(__global const uint* frame, uint origin, struct ScoreArgs args, int x, int y) {
  __global const uchar* const row =
      (__global const uchar*)frame + origin + 4 * (uint)y * args.stride_words;
  const uint f = args.bytes_per_pixel == 1 ? row[x] : ((__global const ushort*)row)[x];
  return (float2)((float)f, 0);
}

static float2 taper(const Work* work, int x, int y) {
  return df_mul(work->taper[x], work->taper[y]);
}

#if LESS_MEAN
// SUM w w f / SUM w w.
static float2 weighted_mean(const Work* work, __global const uint* frame, uint origin,
                            struct ScoreArgs args) {
  float2 sum = (float2)(0, 0);
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const int x = e % N, y = e / N;
    sum = df_add(sum, df_mul(taper(work, x, y), pixel(frame, origin, args, x, y)));
  }
  return df_mul(sum_of_all(work, sum), *work->unit);
}
#endif

#if IS_COSINE
// Which pixel of a line is its sample k.
static int sample_at(int k) { return k < N / 2 ? 2 * k : 2 * (N - k) - 1; }
#else
static int sample_at(int k) { return k; }
#endif

// The tapered pixels; twice them before the FFT, as in fft.cl. Gives the sum of their squares, of an
// entropy, for this thread.
static float2 load(const Work* work, __global const uint* frame, uint origin, struct ScoreArgs args) {
  float2 squares = (float2)(0, 0);
#if LESS_MEAN
  const float2 mean = weighted_mean(work, frame, origin, args);
#endif
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const int x = e % N, y = e / N;
    float2 f = pixel(frame, origin, args, sample_at(x), sample_at(y));
    if (ENTROPY) squares = df_add(squares, two_product(f.x, f.x));
#if LESS_MEAN
    f = df_add(f, -mean);
#endif
    const float2 tapered = df_mul(taper(work, x, y), f);
    work->plane[e] = (float4)(IS_REAL ? tapered : 2 * tapered, 0, 0);
  }
  everybody();
  return squares;
}

static float4 times(float4 a, float4 b) {
  return (float4)(df_add(df_mul(a.xy, b.xy), -df_mul(a.zw, b.zw)),
                  df_add(df_mul(a.xy, b.zw), df_mul(a.zw, b.xy)));
}

// One stage of all rows (or columns) by decimation in frequency.
static void stage(const Work* work, int span, bool along_columns) {
  for (int b = id(); b < N * N / 2; b += WORKGROUP) {
    const int line = b / (N / 2), i = b % (N / 2), r = i % span;
    const int first = (i / span) * 2 * span + r, second = first + span;
    __global float4* const p = work->plane + (along_columns ? first * N + line : line * N + first);
    __global float4* const q = work->plane + (along_columns ? second * N + line : line * N + second);
    const float4 x = *p, y = *q;
    const float4 difference = (float4)(df_add(x.xy, -y.xy), df_add(x.zw, -y.zw));
    *p = (float4)(df_add(x.xy, y.xy), df_add(x.zw, y.zw));
    *q = IS_WALSH || r == 0 ? difference : times(difference, work->roots[r * (N / 2 / span)]);
  }
  everybody();
}

#if IS_COSINE
// The coefficient of an index.
static float4 coefficient_at(const Work* work, int row, int column) {
  const float4 i = work->turns[row], j = work->turns[column];
  __global const float4* const line = work->plane + (int)work->positions[row] * N;
  const float4 v = line[(int)work->positions[column]];
  const float4 u = line[(int)work->positions[(N - column) % N]];
  const float2 re = df_add(df_mul(j.xy, df_add(v.xy, u.xy)), df_mul(j.zw, df_add(v.zw, -u.zw)));
  const float2 im = df_add(df_mul(j.xy, df_add(v.zw, u.zw)), df_mul(j.zw, df_add(u.xy, -v.xy)));
  return (float4)(0.5f * df_add(df_mul(i.xy, re), df_mul(i.zw, im)), 0, 0);
}
#else
static float4 coefficient_at(const Work* work, int row, int column) {
  return work->plane[row * N + column];
}
#endif

// |f| or |f|^2.
static float2 mass(float4 f) {
#if IS_COSINE && !POWER
  return f.x < 0 ? -f.xy : f.xy;
#else
  const float2 square = df_add(df_mul(f.xy, f.xy), df_mul(f.zw, f.zw));
  return POWER ? square : df_sqrt(square);
#endif
}

#if RINGS > 0
// SUM m in each ring; the sums of the first thread's slots are those of all.
static void sum_rings(const Work* work) {
  __local float2* const slots = work->slots;
  for (int ring = 0; ring <= RINGS; ++ring) slots[ring * WORKGROUP + id()] = (float2)(0, 0);
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const int slot = work->rings[e] * WORKGROUP + id();
    slots[slot] = df_add(slots[slot], mass(coefficient_at(work, e / N, e % N)));
  }
  for (int half_way = WORKGROUP / 2; half_way > 0; half_way /= 2) {
    everybody();
    for (int i = id(); i < RINGS * half_way; i += WORKGROUP) {
      const int slot = i / half_way * WORKGROUP + i % half_way;
      slots[slot] = df_add(slots[slot], slots[slot + half_way]);
    }
  }
  everybody();
}

// Of the Fourier plane one half counts.
static void leave_scores(const Work* work, struct ScoreArgs args, uint window, float2 squares,
                         __global uint2* scores) {
  __global uint* const values = (__global uint*)scores + window * RINGS;
  sum_rings(work);
  for (int ring = id(); ring < RINGS; ring += WORKGROUP) {
    const float sum = work->slots[ring * WORKGROUP].x;
    values[ring] = as_uint(IS_REAL ? sum : 0.5f * sum);
  }
}
#else
// Whether a coefficient counts, so far from zero frequency.
static bool is_in_band(struct ScoreArgs args, float squared_radius) {
  return !BANDED ||
         ((uint)squared_radius > args.band_above && (uint)squared_radius <= args.band_to);
}

#if ENTROPY
// SUM p log2 1/p over this thread's coefficients, p = m/L; L follows from the pixels (Parseval).
static float2 measure(const Work* work, struct ScoreArgs args, float2 squares) {
  const float2 energy = sum_of_all(work, squares);
  if (energy.x == 0) return (float2)(0, 0);  // all black
  const float2 inverse = df_inverse(N * df_sqrt(energy));
  float2 sum = (float2)(0, 0);
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const float squared_radius = work->arms[e / N] + work->arms[e % N];
    if (squared_radius == 0 || !is_in_band(args, squared_radius)) continue;
    const float2 p = df_mul(mass(coefficient_at(work, e / N, e % N)), inverse);
    if (p.x > 1e-30f) sum = df_add(sum, (float2)(-p.x * df_log2(p), 0));
  }
  return sum;
}
#else
// SUM m r^2 over this thread's coefficients; of the Fourier plane one half counts.
static float2 measure(const Work* work, struct ScoreArgs args, float2 squares) {
  float2 sum = (float2)(0, 0);
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const float squared_radius = work->arms[e / N] + work->arms[e % N];
    const float4 f = coefficient_at(work, e / N, e % N);
    if (WANTED == FATHOM_COEFFICIENTS) work->spectrum[e] = f;
    if (!is_in_band(args, squared_radius)) continue;
    sum = df_add(sum, df_mul(mass(f), (float2)(squared_radius, 0)));
  }
  return IS_REAL ? sum : 0.5f * sum;
}
#endif

static void leave_scores(const Work* work, struct ScoreArgs args, uint window, float2 squares,
                         __global uint2* scores) {
  const float2 score = sum_of_all(work, measure(work, args, squares));
  if (id() == 0) scores[window] = as_uint2(score);
}
#endif

__kernel __attribute__((reqd_work_group_size(WORKGROUP, 1, 1)))
void exact(__global const uint* frame, __global const uint* window_origins, __global uint2* scores,
           __global const float* tables, __global float4* scratch, __global uint* doubtful,
           __global float4* spectrum, struct ScoreArgs given) {
  const struct ScoreArgs args = given;  // here, where control has not yet gone apart
  __local float2 sums[WORKGROUP];
#if RINGS > 0
  __local float2 slots[(RINGS + 1) * WORKGROUP];
#endif
  const Work work = {(__global const float2*)tables,
                     (__global const float4*)(tables + 2 * N),
                     tables + 4 * N,
#if IS_COSINE
                     (__global const float4*)(tables + 5 * N),
                     tables + 9 * N,
#endif
                     scratch + (ulong)get_group_id(0) * (N * N),
                     spectrum,
                     sums,
#if RINGS > 0
                     (__global const float2*)(tables + (IS_COSINE ? 10 : 5) * N),
                     (__global const uchar*)(tables + (IS_COSINE ? 10 : 5) * N + 2),
                     slots,
#endif
  };
  const uint count = args.windows > 0 ? args.windows : *doubtful;
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    const uint window = args.windows > 0 ? args.first_window + i : doubtful[1 + i];
    const float2 squares = load(&work, frame, window_origins[window], args);
    for (int span = N / 2; span > 0; span /= 2) stage(&work, span, false);
    for (int span = N / 2; span > 0; span /= 2) stage(&work, span, true);
    leave_scores(&work, args, window, squares, scores);
  }
}
