// SPDX-License-Identifier: Apache-2.0
// Focus quality in some 46 bits, as plain as it gets: for windows that fft.cl does not trust its own
// single precision with, for bands, which may leave out nearly all that a picture holds, and for
// Walsh transforms under a taper.
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
#endif
#include "double_float.clh"

// What a thread works with.
typedef struct {
  __global const float2* taper;  // [N]
  __global const float4* roots;  // [N/2]: exp(-2 pi i k/N)
  __global const float* arms;    // [N]: squared, by position
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

// The tapered pixels; twice them before the FFT, as in fft.cl.
static void load(const Work* work, __global const uint* frame, uint origin, struct ScoreArgs args) {
#if LESS_MEAN
  const float2 mean = weighted_mean(work, frame, origin, args);
#endif
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const int x = e % N, y = e / N;
    float2 f = pixel(frame, origin, args, x, y);
#if LESS_MEAN
    f = df_add(f, -mean);
#endif
    const float2 tapered = df_mul(taper(work, x, y), f);
    work->plane[e] = (float4)(IS_WALSH ? tapered : 2 * tapered, 0, 0);
  }
  everybody();
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

// |f| or |f|^2.
static float2 mass(float4 f) {
  const float2 square = df_add(df_mul(f.xy, f.xy), df_mul(f.zw, f.zw));
  return POWER ? square : df_sqrt(square);
}

#if RINGS > 0
// SUM m in each ring; the sums of the first thread's slots are those of all.
static void sum_rings(const Work* work) {
  __local float2* const slots = work->slots;
  for (int ring = 0; ring <= RINGS; ++ring) slots[ring * WORKGROUP + id()] = (float2)(0, 0);
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const int slot = work->rings[e] * WORKGROUP + id();
    slots[slot] = df_add(slots[slot], mass(work->plane[e]));
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
static void leave_scores(const Work* work, struct ScoreArgs args, uint window,
                         __global uint2* scores) {
  __global uint* const values = (__global uint*)scores + window * RINGS;
  sum_rings(work);
  for (int ring = id(); ring < RINGS; ring += WORKGROUP) {
    const float sum = work->slots[ring * WORKGROUP].x;
    values[ring] = as_uint(IS_WALSH ? sum : 0.5f * sum);
  }
}
#else
// SUM m r^2 over this thread's coefficients; of the Fourier plane one half counts.
static float2 moment(const Work* work, struct ScoreArgs args) {
  float2 sum = (float2)(0, 0);
  for (int e = id(); e < N * N; e += WORKGROUP) {
    const float squared_radius = work->arms[e / N] + work->arms[e % N];
    const float4 f = work->plane[e];
    if (WANTED == FATHOM_COEFFICIENTS) work->spectrum[e] = f;
    if (BANDED && ((uint)squared_radius <= args.band_above || (uint)squared_radius > args.band_to))
      continue;
    sum = df_add(sum, df_mul(mass(f), (float2)(squared_radius, 0)));
  }
  return IS_WALSH ? sum : 0.5f * sum;
}

static void leave_scores(const Work* work, struct ScoreArgs args, uint window,
                         __global uint2* scores) {
  const float2 score = sum_of_all(work, moment(work, args));
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
                     scratch + (ulong)get_group_id(0) * (N * N),
                     spectrum,
                     sums,
#if RINGS > 0
                     (__global const float2*)(tables + 5 * N),
                     (__global const uchar*)(tables + 5 * N + 2),
                     slots,
#endif
  };
  const uint count = args.windows > 0 ? args.windows : *doubtful;
  for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
    const uint window = args.windows > 0 ? args.first_window + i : doubtful[1 + i];
    load(&work, frame, window_origins[window], args);
    for (int span = N / 2; span > 0; span /= 2) stage(&work, span, false);
    for (int span = N / 2; span > 0; span /= 2) stage(&work, span, true);
    leave_scores(&work, args, window, scores);
  }
}
