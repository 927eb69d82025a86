// SPDX-License-Identifier: Apache-2.0
// Focus quality by the Walsh-Hadamard transform without a taper, from pixels to one number per
// window, or to one for each of its RINGS, to the last bit (thesis eq. 5-2). What is computed is N^2 W
// in natural (Hadamard) order; the other orders hold the same coefficients, so a table of lever arms is all that they are.
//
// Compiled as one of two: IN_FLOAT, which is exact up to 2^24 and twice as fast as integers on many
// GPUs, for 8-bit pixels and N <= 256 (|W| <= 128 N^2 = 2^23); in 32-bit integers for the rest. What
// would not fit there (16-bit pixels, N = 512) is split before its last stages (PLANES).
//
// The middle of the pixels' range is subtracted: it is the coefficient (0, 0) alone that it shows
// in, which no lever arm reaches and no ring holds.
#ifdef IN_FLOAT
#define Scalar float
#define Number Real
#else
#define Scalar int
#define Number Int
#endif
#include "window.clh"

#if RINGS > 0
#define NO_RING RINGS
#define RING_SLOTS (RINGS + 1)
#define RING_SLOTS_START 0
#define RING_LIMBS_START (RING_SLOTS * THREADS)  // of the team's sums, three for each ring
#define SUMMED (RING_LIMBS_START + 3 * RINGS)
#include "rings.clh"
#endif
#if RINGS > 0 && LANES == 1 && SUMMED > EXCHANGE
#define POOL SUMMED
#else
#define POOL EXCHANGE
#endif

// What a thread works with.
typedef struct {
  __global const uint* arms;  // [N]: squared lever arm of the coefficient at each natural position
  __global int2* spectrum;    // [N][N]: 2^12 x + y
  SCRATCH Scalar* scratch;    // two planes
  __local Scalar* pool;       // the team's part
  struct ScoreArgs args;
#if RINGS > 0
  __global const uchar* slots;  // [N][N]: where the coefficient at two positions goes to
  __local ulong* alone;         // [RING_SLOTS], of a thread that takes a window alone
#endif
} Work;

// This thread's part of its lines: of columns l and l + N/2 the sum and the difference, of rows their
// left and right halves.
typedef struct {
  Number part[2][POINTS];
} Line;

INLINED void butterfly(Line* z, int first, int second) {
  UNROLL for (int c = 0; c < 2; ++c) {
    const Number x = z->part[c][first], y = z->part[c][second];
    z->part[c][first] = x + y;
    z->part[c][second] = x - y;
  }
}

// The butterflies of two stages.
INLINED void join_four(Line* z, int i, int span) {
  for (int c = 0; c < 2; ++c) {
    Number* const v = z->part[c] + i;
    const Number x = v[0] + v[span], x_ = v[0] - v[span];
    const Number y = v[2 * span] + v[3 * span], y_ = v[2 * span] - v[3 * span];
    v[0] = x + y;
    v[span] = x_ + y_;
    v[2 * span] = x - y;
    v[3 * span] = x_ - y_;
  }
}

// Transforms each run of `points` registers.
INLINED void transform_registers(Line* z, int points) {
#if LANES == 1
  UNROLL for (int stage = 0; stage < 6; ++stage) {
    const int span = 1 << stage;
    UNROLL for (int i = 0; i < POINTS / 2; ++i) {
      if (span >= points) continue;  // no such stage
      const int first = (i / span) * 2 * span + i % span;
      butterfly(z, first, first + span);
    }
  }
#else
  // Two stages at once, or every value would go to memory and back for each.
  int span = 1;
  for (; 4 * span <= points; span *= 4) {
    for (int first = 0; first < POINTS; first += 4 * span) {
      for (int i = first; i < first + span; ++i) join_four(z, i, span);
    }
  }
  for (; span < points; span *= 2) {
    for (int first = 0; first < POINTS; first += 2 * span) {
      for (int i = first; i < first + span; ++i) butterfly(z, i, i + span);
    }
  }
#endif
}

// The position along its line of the coefficient that register p holds after transform_line; those
// of a run of half a line count from its start.
INLINED int position(int p) { return (part_of_line() + SPLIT * (p / SPLIT)) * SPLIT + p % SPLIT; }

// The transform of a line, or of its halves alone, whose sample part + SPLIT a is register a: over a,
// then, where threads share the line, over the parts.
INLINED void transform_line(const Work* work, Line* z, bool is_whole) {
  transform_registers(z, POINTS / 2);
  if (is_whole) {
    UNROLL for (int i = 0; i < POINTS / 2; ++i) butterfly(z, i, i + POINTS / 2);
  }
#if LANES == 1
  if (SPLIT == 1) return;
  const int line = line_of_tile(), part = part_of_line();
  UNROLL for (int c = 0; c < 2; ++c) {
    everybody();
    UNROLL for (int p = 0; p < POINTS; ++p) {
      work->pool[(p * SPLIT + part) * PITCH + line] = z->part[c][p];
    }
    everybody();
    UNROLL for (int p = 0; p < POINTS; ++p) {
      z->part[c][p] = work->pool[position(p) * PITCH + line];
    }
  }
  transform_registers(z, SPLIT);
#endif
}

// Pixels less the middle of the range.
INLINED Number centred(Uint pixels) {
#ifdef IN_FLOAT
  return level_above(pixels, 1u << (8 * BYTES - 1));
#else
  return TO_INT(pixels) - (1 << (8 * BYTES - 1));
#endif
}

// Columns l and l + N/2, and already the one stage of the rows that joins them.
INLINED void load_columns(Line* z, Picture picture, int l) {
  UNROLL for (int a = 0; a < POINTS; ++a) {
    const int y = part_of_line() + SPLIT * a;
    const Number f = centred(pixels(picture, l, y)), g = centred(pixels(picture, l + N / 2, y));
    z->part[0][a] = f + g;
    z->part[1][a] = f - g;
  }
}

#if MEETS_IN_POOL
// Gives up the line of columns; takes the rows v (registers below POINTS/2) and v + N/2 (the rest)
// instead, of the lines l = part + SPLIT a.
INLINED void take_rows_from_pool(const Work* work, Line* z, int v) {
  const int line = line_of_tile();
  UNROLL for (int c = 0; c < 2; ++c) {
    everybody();
    UNROLL for (int p = 0; p < POINTS; ++p) {
      work->pool[pool_at(position(p), line)] = z->part[c][p];
    }
    everybody();
    UNROLL for (int a = 0; a < POINTS / 2; ++a) {
      const int l = part_of_line() + SPLIT * a;
      z->part[c][a] = work->pool[pool_at(v, l)];
      z->part[c][a + POINTS / 2] = work->pool[pool_at(v + N / 2, l)];
    }
  }
}
#else
// Lines of columns to the scratch memory, [line][row].
INLINED void leave_columns(const Work* work, const Line* z, int l) {
  UNROLL for (int c = 0; c < 2; ++c) {
    SCRATCH Scalar* const lines = work->scratch + c * SCRATCH_PLANE + l * SCRATCH_PITCH;
#if LANES == 1
    UNROLL for (int p = 0; p < POINTS; ++p) lines[position(p)] = z->part[c][p];
#else
    for (int v = 0; v < N; v += LANES) {
      Number block[LANES];
      for (int i = 0; i < LANES; ++i) block[i] = z->part[c][v + i];
      transpose(block);
      for (int i = 0; i < LANES; ++i) STORE(block[i], lines + i * SCRATCH_PITCH + v);
    }
#endif
  }
}

// Rows v, v + 1, .. and v + N/2, .., of two planes the one: value = 2^12 upper + lower.
INLINED void take_rows(const Work* work, Line* z, int v, int plane) {
  UNROLL for (int c = 0; c < 2; ++c) {
    UNROLL for (int a = 0; a < POINTS / 2; ++a) {
      const SCRATCH Scalar* const line =
          work->scratch + c * SCRATCH_PLANE + (part_of_line() + SPLIT * a) * SCRATCH_PITCH + v;
      z->part[c][a] = LOAD(line);
      z->part[c][a + POINTS / 2] = LOAD(line + N / 2);
    }
#if PLANES == 2
    UNROLL for (int p = 0; p < POINTS; ++p) {
      const Number value = z->part[c][p];
      z->part[c][p] = plane == 0 ? value >> 12 : value & 0xfff;
    }
#endif
  }
}
#endif

// Sums of magnitudes |W|. Above 2^23 the bits of a float count in ones, which is cheaper than a
// conversion: in float every term brings the bits of 2^23 with it, and without_bits takes them away
// from the sum.
#ifdef IN_FLOAT
typedef Uint Mass;
typedef uint ScalarMass;
#define LIMBS 1  // 32-bit words of a sum
#define NOTHING 0x4b000000u  // of one term
#else
typedef LANES_OF(ulong) Mass;
typedef ulong ScalarMass;
#define LIMBS 2
#define NOTHING 0ul
#endif

INLINED ScalarMass without_bits(ScalarMass sum, int terms) { return sum - (uint)terms * NOTHING; }

INLINED Mass magnitude(Number lower, Number upper) {
#ifdef IN_FLOAT
  return AS_UINT(fabs(lower) + 8388608.0f);
#elif PLANES == 1
  return JOIN(convert_, LANES_OF(ulong))(abs(lower));
#else
  const LANES_OF(long) value = JOIN(convert_, LANES_OF(long))(upper) * 4096 +
                               JOIN(convert_, LANES_OF(long))(lower);
  return abs(value);
#endif
}

INLINED Real value_of(Mass term) {
#ifdef IN_FLOAT
  return AS_REAL(term) - 8388608.0f;
#else
  return TO_REAL(term);
#endif
}

INLINED bool in_band(struct ScoreArgs args, uint squared_radius) {
  return args.band_above < squared_radius && squared_radius <= args.band_to;
}

// What counts of terms m at these squared radii.
INLINED Mass in_band_only(const Work* work, Mass m, Uint squared_radius) {
#if BANDED && LANES == 1
  return in_band(work->args, squared_radius) ? m : NOTHING;
#elif BANDED
  const Uint is_in = AS_UINT(squared_radius > work->args.band_above &&
                             squared_radius <= work->args.band_to);
#ifdef IN_FLOAT
  return select((Mass)NOTHING, m, is_in);
#else
  return select((Mass)NOTHING, m, JOIN(convert_, LANES_OF(ulong))(is_in) << 32);
#endif
#else
  return m;
#endif
}

INLINED ScalarMass sum_of_lanes(Mass v) {
  ScalarMass sum = 0;
  for (int i = 0; i < LANES; ++i) sum += ((const ScalarMass*)&v)[i];
  return sum;
}

#if RINGS > 0
#include "walsh_rings.clh"
#else
// Of a team, and of this thread's part of it.
typedef struct {
  Mass columns[POINTS / 2][2];  // SUM |W| of each column over this thread's two rows
  ulong moment;
  Real power, block_power, pair_power;  // of everything, of a block of registers, of one register pair
} Sums;

// |W| of row i, column j, if it counts; row_arm: of the rows i, i + 1, ..
INLINED Mass term(const Work* work, Sums* sums, Number lower, Number upper, int i, int j,
                 Uint row_arm) {
#if WANTED == FATHOM_COEFFICIENTS
  for (int k = 0; k < LANES; ++k) {
    work->spectrum[(i + k) * N + j] = (int2)(PLANES == 2 ? (int)((const Scalar*)&upper)[k] : 0,
                                             (int)((const Scalar*)&lower)[k]);
  }
#endif
  const Uint squared_radius = row_arm + work->arms[j];
  const Mass m = in_band_only(work, magnitude(lower, upper), squared_radius);
#if POWER
  sums->pair_power += value_of(m) * value_of(m) * TO_REAL(squared_radius);
#endif
  return m;
}

INLINED void add_row_moments(Sums* sums, Uint arms, Mass row) {
  for (int i = 0; i < LANES; ++i) {
    sums->moment += (ulong)((const uint*)&arms)[i] *
                    without_bits(((const ScalarMass*)&row)[i], POINTS);
  }
}

// Rows v, v + 1, .. and v + N/2, .. of natural order. I_z = I_x + I_y: rows at once, columns gathered.
INLINED void add_rows(const Work* work, Sums* sums, const Line* lower, const Line* upper, int v) {
  const Uint upper_arms = LOAD(work->arms + v), lower_arms = LOAD(work->arms + v + N / 2);
  Mass upper_row = 0, lower_row = 0;
  UNROLL for (int p = 0; p < POINTS / 2; ++p) {
    UNROLL for (int c = 0; c < 2; ++c) {
      const int j = position(p) + c * N / 2, q = p + POINTS / 2;
      const Mass m =
          term(work, sums, lower->part[c][p], upper->part[c][p], v, j, upper_arms);
      const Mass n =
          term(work, sums, lower->part[c][q], upper->part[c][q], v + N / 2, j, lower_arms);
      upper_row += m;
      lower_row += n;
#if LANES == 1
      sums->columns[p][c] = m + n;
#else
      sums->columns[p][c] += m + n;
#endif
    }
#if POWER
    // Sums of sums: one long one would round too often.
    sums->block_power += sums->pair_power;
    sums->pair_power = 0;
    if (p % BLOCK == BLOCK - 1 || p == POINTS / 2 - 1) {
      sums->power += sums->block_power;
      sums->block_power = 0;
    }
#endif
  }
  if (POWER) return;
  add_row_moments(sums, upper_arms, upper_row);
  add_row_moments(sums, lower_arms, lower_row);
}

#if LANES == 1
// Every thread has sums over its two rows of the columns at its positions. Now it adds up, for the
// columns of its line, LINES/SPLIT threads' sums.
INLINED void add_columns(const Work* work, Sums* sums) {
  const int line = line_of_tile();
  __local uint* const pool = (__local uint*)work->pool;
  Mass columns[N / LINES];
  UNROLL for (int q = 0; q < N / LINES; ++q) columns[q] = 0;
  UNROLL for (int i = 0; i < LIMBS; ++i) {
    everybody();
    UNROLL for (int p = 0; p < POINTS / 2; ++p) {
      UNROLL for (int c = 0; c < 2; ++c) {
        pool[pool_at(position(p) + c * N / 2, line)] = (uint)(sums->columns[p][c] >> (31 * i) >> i);
      }
    }
    everybody();
    UNROLL for (int q = 0; q < N / LINES; ++q) {
      UNROLL for (int a = 0; a < LINES / SPLIT; ++a) {
        const int other = part_of_line() + SPLIT * a;
        columns[q] += (Mass)pool[pool_at(line + LINES * q, other)] << (31 * i) << i;
      }
    }
  }
  UNROLL for (int q = 0; q < N / LINES; ++q) {
    sums->moment += (ulong)work->arms[line + LINES * q] *
                    without_bits(columns[q], 2 * LINES / SPLIT);
  }
}
#else
// The thread has sums over all rows in its lanes.
INLINED void add_columns(const Work* work, Sums* sums) {
  for (int p = 0; p < N / 2; ++p) {
    for (int c = 0; c < 2; ++c) {
      sums->moment += (ulong)work->arms[p + c * N / 2] *
                      without_bits(sum_of_lanes(sums->columns[p][c]), N);
    }
  }
}
#endif

// The sum of the team's totals, for its first member.
INLINED ulong team_sum(const Work* work, ulong moment, float power) {
  __local uint* const low = (__local uint*)work->pool + member();
  __local uint* const high = low + THREADS;
  everybody();
  *low = POWER ? as_uint(power) : (uint)moment;
  *high = (uint)(moment >> 32);
  for (int half_way = THREADS / 2; half_way > 0; half_way /= 2) {
    everybody();
    if (member() < half_way) {
#if POWER
      *low = as_uint(as_float(*low) + as_float(low[half_way]));
#else
      const ulong sum = upsample(*high, *low) + upsample(high[half_way], low[half_way]);
      *low = (uint)sum;
      *high = (uint)(sum >> 32);
#endif
    }
  }
  everybody();
  return upsample(*high, *low);
}

INLINED float sum_of_real_lanes(Real v) {
  float sum = 0;
  for (int i = 0; i < LANES; ++i) sum += ((const float*)&v)[i];
  return sum;
}

INLINED void clear_sums(const Work* work, Sums* sums) {
  sums->moment = 0;
  sums->power = sums->block_power = sums->pair_power = 0;
#if LANES > 1
  for (int p = 0; p < POINTS / 2; ++p) sums->columns[p][0] = sums->columns[p][1] = 0;
#endif
}

// Adds the moment of one tile of rows.
INLINED void add_tile(const Work* work, Sums* sums, const Line* lower, const Line* upper, int v) {
  add_rows(work, sums, lower, upper, v);
#if LANES == 1
  if (!POWER) add_columns(work, sums);
#endif
}

// SUM |W| r^2 as an integer; with POWER SUM W^2 r^2 as the bits of a float.
INLINED void leave_scores(const Work* work, Sums* sums, struct ScoreArgs args, uint window,
                          __global uint2* scores) {
#if LANES > 1
  if (!POWER) add_columns(work, sums);
#endif
  const ulong sum = team_sum(work, sums->moment, sum_of_real_lanes(sums->power));
  if (member() == 0 && window_is_ours(args)) {
    scores[window] = (uint2)((uint)sum, (uint)(sum >> 32));
  }
}
#endif

// The sums of one window.
INLINED void score_window(const Work* work, Sums* sums, Picture picture) {
  Line z;
  clear_sums(work, sums);
#if MEETS_IN_POOL
  const int line = line_of_tile();
  load_columns(&z, picture, line);
  transform_line(work, &z, true);
  take_rows_from_pool(work, &z, line);
  transform_line(work, &z, false);
  add_tile(work, sums, &z, &z, line);
#else
  for (int tile = 0; tile < TILES; ++tile) {
    const int line = tile * LINES + line_of_tile();
    load_columns(&z, picture, line);
    transform_line(work, &z, true);
    leave_columns(work, &z, line);
  }
  pass_on();
  for (int tile = 0; tile < TILES; ++tile) {
    const int line = tile * LINES + line_of_tile();
    Line upper;
    for (int plane = 0; plane < PLANES; ++plane) {
      if (plane > 0) upper = z;
      take_rows(work, &z, line, plane);
      transform_line(work, &z, false);
    }
    add_tile(work, sums, &z, PLANES == 2 ? &upper : &z, line);
  }
#endif
}

__kernel __attribute__((reqd_work_group_size(WORKGROUP, 1, 1)))
void walsh(__global const uint* frame, __global const uint* window_origins, __global uint2* scores,
           __global const uint* tables, __global Scalar* scratch, __global uint* doubtful,
           __global int2* spectrum, struct ScoreArgs given) {
  const struct ScoreArgs args = given;  // here, where control has not yet gone apart
  __local Scalar pool[POOL * TEAMS];
#if ON_CHIP
  __local Scalar scratch_here[2 * SCRATCH_PLANE];
#else
  __global Scalar* const scratch_here = scratch + (ulong)get_group_id(0) * (2 * SCRATCH_PLANE);
#endif
#if RINGS > 0
  __local ulong alone[LANES > 1 ? RING_SLOTS : 1];
  const Work work = {tables,
                     spectrum,
                     scratch_here,
                     pool + team() * POOL,
                     args,
                     (__global const uchar*)(tables + N),
                     alone};
#else
  const Work work = {tables, spectrum, scratch_here, pool + team() * POOL, args};
#endif
  const uint window = window_index(args);
  Sums sums;
  score_window(&work, &sums, picture_at(frame, window_origins[window], args));
  leave_scores(&work, &sums, args, window, scores);
}
