// SPDX-License-Identifier: Apache-2.0
// Focus quality by the Fourier transform, from pixels to one number per window (thesis eqs. 3-10,
// 5-1), or to one for each of its RINGS, in single precision; windows that it is not enough for are
// listed for exact.cl.
//
// What is summed is 2 N^2 F of half of the plane, which has the mass of all of it twice over; the
// host multiplies by the factors that are left. Two real columns are one complex line:
//
//   z = a + i b,   2A(v) = Z(v) + conj Z(-v),   2B(v) = -i (Z(v) - conj Z(-v))
//
// and the rows v = 0 and v = N/2, real both as columns come out of them, are one complex line too,
// line 0 of the second pass.
#include "window.clh"

#if RINGS > 0
// Beside the rings the sums of 1/|f| and of the energy, and what lies in no ring.
#define SLOT_OF_INVERSES RINGS
#define SLOT_OF_ENERGY (RINGS + 1)
#define NO_RING (RINGS + 2)
#define RING_SLOTS (RINGS + 3)
#define RING_SLOTS_START (2 * (N + 1))
#define RING_PITCH (N / 2 + FATHOM_RING_MARGIN)
#define SUMMED (RING_SLOTS_START + RING_SLOTS * THREADS)
#include "rings.clh"
#endif
#if RINGS > 0 && LANES == 1 && SUMMED > EXCHANGE
#define POOL SUMMED
#else
#define POOL EXCHANGE
#endif

// What a thread works with.
typedef struct {
  __global const float* taper;   // [N]
  __global const float2* flat;   // [N]: N W(k), the transform of a constant 1 under the taper
  __global const float2* roots;  // [N]: exp(-2 pi i k/N)
  __global float2* spectrum;     // [N/2 + 1][N]
  SCRATCH float* scratch;        // two planes
  __local float* pool;           // the team's part
  uint grey;                     // level that is left out of the sums
  float level;                   // what comes back to them at the end
#if RINGS > 0
  __global const float* rules;   // [RINGS][4]: what ring_is_doubtful knows of each
  __global const uchar* slots;   // [|u|][|v|], rows of RING_PITCH: where a coefficient goes to
  __local float2* alone;         // [RING_SLOTS], of a thread that takes a window alone
#endif
} Work;

// This thread's part of its lines: real parts, imaginary parts.
typedef struct {
  Real part[2][POINTS];
} Line;
#define RE 0
#define IM 1

typedef struct {
  Real re, im;
} Complex;

INLINED Complex at(const Line* z, int p) {
  const Complex value = {z->part[RE][p], z->part[IM][p]};
  return value;
}
INLINED void set(Line* z, int p, Real re, Real im) {
  z->part[RE][p] = re;
  z->part[IM][p] = im;
}
INLINED void set_complex(Line* z, int p, Complex value) { set(z, p, value.re, value.im); }
INLINED Complex times(Complex a, float2 b) {
  const Complex product = {a.re * b.x - a.im * b.y, a.re * b.y + a.im * b.x};
  return product;
}

// exp(-2 pi i k/64), k = 0 .. 31.
__constant float2 kRoot[32] = {
  (float2)(1.0f, 0.0f), (float2)(0.99518472667219693f, -0.098017140329560604f),
  (float2)(0.98078528040323043f, -0.19509032201612825f), (float2)(0.95694033573220882f, -0.29028467725446233f),
  (float2)(0.92387953251128674f, -0.38268343236508977f), (float2)(0.88192126434835505f, -0.47139673682599764f),
  (float2)(0.83146961230254524f, -0.55557023301960218f), (float2)(0.77301045336273699f, -0.63439328416364549f),
  (float2)(0.70710678118654757f, -0.70710678118654757f), (float2)(0.63439328416364549f, -0.77301045336273699f),
  (float2)(0.55557023301960218f, -0.83146961230254524f), (float2)(0.47139673682599764f, -0.88192126434835505f),
  (float2)(0.38268343236508977f, -0.92387953251128674f), (float2)(0.29028467725446233f, -0.95694033573220882f),
  (float2)(0.19509032201612825f, -0.98078528040323043f), (float2)(0.098017140329560604f, -0.99518472667219693f),
  (float2)(0.0f, -1.0f), (float2)(-0.098017140329560604f, -0.99518472667219693f),
  (float2)(-0.19509032201612825f, -0.98078528040323043f), (float2)(-0.29028467725446233f, -0.95694033573220882f),
  (float2)(-0.38268343236508977f, -0.92387953251128674f), (float2)(-0.47139673682599764f, -0.88192126434835505f),
  (float2)(-0.55557023301960218f, -0.83146961230254524f), (float2)(-0.63439328416364549f, -0.77301045336273699f),
  (float2)(-0.70710678118654757f, -0.70710678118654757f), (float2)(-0.77301045336273699f, -0.63439328416364549f),
  (float2)(-0.83146961230254524f, -0.55557023301960218f), (float2)(-0.88192126434835505f, -0.47139673682599764f),
  (float2)(-0.92387953251128674f, -0.38268343236508977f), (float2)(-0.95694033573220882f, -0.29028467725446233f),
  (float2)(-0.98078528040323043f, -0.19509032201612825f), (float2)(-0.99518472667219693f, -0.098017140329560604f)};

#if LANES == 1
// Transforms each run of `points` registers by decimation in frequency; frequencies come out in
// the order of reversed bits.
INLINED void transform_registers(Line* z, int points) {
  UNROLL for (int stage = 0; stage < 6; ++stage) {
    const int span = points >> (stage + 1);
    UNROLL for (int i = 0; i < POINTS / 2; ++i) {
      if (span == 0) continue;  // no such stage
      const int r = i % span, upper = (i / span) * 2 * span + r, lower = upper + span;
      const Complex x = at(z, upper), y = at(z, lower);
      const Complex difference = {x.re - y.re, x.im - y.im};
      set(z, upper, x.re + y.re, x.im + y.im);
      if (r == 0) {
        set(z, lower, difference.re, difference.im);
      } else if (2 * r == span) {
        set(z, lower, difference.im, -difference.re);
      } else {
        const Complex turned = times(difference, kRoot[r * (32 / span)]);
        set(z, lower, turned.re, turned.im);
      }
    }
  }
}
#else
// Four lines of Stockham's transform, which sorts as it goes: of `runs` runs of values that are
// transformed already, each `length` long, every four become one.
INLINED void join_four(const Work* work, const Line* from, Line* to, int runs, int length) {
  const int quarter = runs / 4;
  for (int p = 0; p < quarter; ++p) {
    const float2 first = work->roots[p * length], second = work->roots[2 * p * length];
    const float2 third = work->roots[3 * p * length];
    for (int q = 0; q < length; ++q) {
      const Complex a = at(from, q + length * p), b = at(from, q + length * (p + quarter));
      const Complex c = at(from, q + length * (p + 2 * quarter));
      const Complex d = at(from, q + length * (p + 3 * quarter));
      const Complex ac = {a.re + c.re, a.im + c.im}, bd = {b.re + d.re, b.im + d.im};
      const Complex a_c = {a.re - c.re, a.im - c.im}, b_d = {b.re - d.re, b.im - d.im};
      const int out = q + length * 4 * p;
      set(to, out, ac.re + bd.re, ac.im + bd.im);
      const Complex one = {a_c.re + b_d.im, a_c.im - b_d.re};
      const Complex two = {ac.re - bd.re, ac.im - bd.im};
      const Complex three = {a_c.re - b_d.im, a_c.im + b_d.re};
      set_complex(to, out + length, times(one, first));
      set_complex(to, out + 2 * length, times(two, second));
      set_complex(to, out + 3 * length, times(three, third));
    }
  }
}

// The last two become one.
INLINED void join_two(const Line* from, Line* to) {
  for (int q = 0; q < N / 2; ++q) {
    const Complex a = at(from, q), b = at(from, q + N / 2);
    set(to, q, a.re + b.re, a.im + b.im);
    set(to, q + N / 2, a.re - b.re, a.im - b.im);
  }
}

// Transforms a whole line; frequencies come out in order, in one of the two.
INLINED Line* transform_vectors(const Work* work, Line* z, Line* spare) {
  int length = 1;
  for (; 4 * length <= N; length *= 4) {
    join_four(work, z, spare, N / length, length);
    Line* const done = spare;
    spare = z;
    z = done;
  }
  if (length == N) return z;
  join_two(z, spare);
  return spare;
}
#endif

// The frequency that register p holds after transform_line.
INLINED int frequency(int p) {
  if (LANES > 1) return p;
  if (SPLIT == 1) return reversed_bits(p, POINTS);
  return part_of_line() + SPLIT * (p / SPLIT) + POINTS * reversed_bits(p % SPLIT, SPLIT);
}

// The transform of a line whose sample part + SPLIT a is register a. Where threads share the line:
// over a first, giving frequency k1, a turn by exp(-2 pi i part k1/N), then over the parts. Vectors
// need a spare line, and may leave the result there.
INLINED Line* transform_line(const Work* work, Line* z, Line* spare) {
#if LANES > 1
  return transform_vectors(work, z, spare);
#else
  transform_registers(z, POINTS);
  if (SPLIT == 1) return z;
  const int line = line_of_tile(), part = part_of_line();
  UNROLL for (int p = 1; p < POINTS; ++p) {
    const Complex turned = times(at(z, p), work->roots[part * reversed_bits(p, POINTS)]);
    set(z, p, turned.re, turned.im);
  }
  UNROLL for (int c = 0; c < 2; ++c) {
    everybody();
    UNROLL for (int p = 0; p < POINTS; ++p) {
      work->pool[(reversed_bits(p, POINTS) * SPLIT + part) * PITCH + line] = z->part[c][p];
    }
    everybody();
    UNROLL for (int p = 0; p < POINTS; ++p) {
      const int k1 = part + SPLIT * (p / SPLIT);
      z->part[c][p] = work->pool[(k1 * SPLIT + p % SPLIT) * PITCH + line];
    }
  }
  transform_registers(z, SPLIT);
  return z;
#endif
}

// A grey level near the mean: what is common to all pixels is left out of the sums and put back at
// the end, or its rounding would drown a faint picture. The mean of eight pixels on a lattice, whole.
INLINED uint grey_level(Picture picture) {
  uint sum = 0;
  for (int k = 0; k < 8; ++k) {
    const uint y = (2 * (3 * k % 8) + 1) * N / 16;
    sum += picture.first[y * picture.stride + (2 * k + 1) * N / 16];
  }
  return sum / 8;
}

// Columns l and l + N/2, tapered; returns the sum of their squares.
INLINED Real load_columns(const Work* work, Line* z, Picture picture, int l) {
  const Real left = LOAD(work->taper + l), right = LOAD(work->taper + l + N / 2);
  Real energy = 0;
  UNROLL for (int a = 0; a < POINTS; ++a) {
    const int y = part_of_line() + SPLIT * a;
    const Real f = level_above(pixels(picture, l, y), work->grey) * left * work->taper[y];
    const Real g = level_above(pixels(picture, l + N / 2, y), work->grey) * right * work->taper[y];
    set(z, a, f, g);
    energy += f * f + g * g;
  }
  return energy;
}

#if MEETS_IN_POOL
// Gives up the line of columns; takes samples of the rows v and w of Z instead: of the lines l =
// part + SPLIT a, Z(v) in register a and Z(w) in register a + POINTS/2.
INLINED void take_rows_from_pool(const Work* work, Line* z, int v) {
  const int line = line_of_tile(), w = v == 0 ? N / 2 : N - v;
  UNROLL for (int c = 0; c < 2; ++c) {
    everybody();
    UNROLL for (int p = 0; p < POINTS; ++p) {
      work->pool[pool_at(frequency(p), line)] = z->part[c][p];
    }
    everybody();
    UNROLL for (int a = 0; a < POINTS / 2; ++a) {
      const int l = part_of_line() + SPLIT * a;
      z->part[c][a] = work->pool[pool_at(v, l)];
      z->part[c][a + POINTS / 2] = work->pool[pool_at(w, l)];
    }
  }
}
#else
// Lines of columns to the scratch memory, [line][row]. The row N/2 comes once more, as row N: where
// the mirror image of row 0 would be, which is its own.
INLINED void leave_columns(const Work* work, const Line* z, int l) {
  UNROLL for (int c = 0; c < 2; ++c) {
    SCRATCH float* const lines = work->scratch + c * SCRATCH_PLANE + l * SCRATCH_PITCH;
#if LANES == 1
    UNROLL for (int p = 0; p < POINTS; ++p) {
      const int v = frequency(p);
      lines[v] = z->part[c][p];
      if (v == N / 2) lines[N] = z->part[c][p];
    }
#else
    for (int v = 0; v < N; v += LANES) {
      Real block[LANES];
      for (int i = 0; i < LANES; ++i) block[i] = z->part[c][v + i];
      transpose(block);
      for (int i = 0; i < LANES; ++i) STORE(block[i], lines + i * SCRATCH_PITCH + v);
    }
    for (int i = 0; i < LANES; ++i) {
      lines[i * SCRATCH_PITCH + N] = lines[i * SCRATCH_PITCH + N / 2];
    }
#endif
  }
}

// Samples of the rows v, v + 1, .. and of their mirror images, of the lines l = part + SPLIT a.
INLINED void take_rows(const Work* work, Line* z, int v) {
  UNROLL for (int c = 0; c < 2; ++c) {
    const SCRATCH float* const plane = work->scratch + c * SCRATCH_PLANE;
    UNROLL for (int a = 0; a < POINTS / 2; ++a) {
      const SCRATCH float* const line = plane + (part_of_line() + SPLIT * a) * SCRATCH_PITCH;
      z->part[c][a] = LOAD(line + v);
      z->part[c][a + POINTS / 2] = reversed_lanes(LOAD(line + N - v - (LANES - 1)));
    }
  }
}
#endif

// From rows v and -v of Z to the samples of row v, or of the rows 0 and N/2, along x.
INLINED void separate_columns(Line* z, int v) {
  const Int is_mirror = lanes_from(v) == 0;
  UNROLL for (int a = 0; a < POINTS / 2; ++a) {
    const Complex p = at(z, a), q = at(z, a + POINTS / 2);
    set(z, a, select(p.re + q.re, p.re, is_mirror), select(p.im - q.im, q.re, is_mirror));
    set(z, a + POINTS / 2, select(p.im + q.im, p.im, is_mirror),
        select(q.re - p.re, q.im, is_mirror));
  }
}

INLINED int signed_frequency(int k) { return k < N / 2 ? k : k - N; }

// |f| and 1/|f|, or |f|^2 alone, summed.
typedef struct {
  Real mass, inverse;
} Mass;

INLINED void add(Mass* sum, Mass m, Real weight) {
  sum->mass += m.mass * weight;
  sum->inverse += m.inverse * weight;
}

INLINED Mass mass(Complex f) {
  const Real square = f.re * f.re + f.im * f.im;
#if POWER
  const Mass m = {square, 0};
#else
  const Real inverse = rsqrt(max(square, (Real)1e-30f));
  const Mass m = {square * inverse, inverse};
#endif
  return m;
}

// Numbers x + i y from x, y, x, y, ...
INLINED Complex complex_at(__global const float2* from) {
  __global const float* const numbers = (__global const float*)from;
#if LANES == 1
  const Complex value = {numbers[0], numbers[1]};
#else
  const Real first = LOAD(numbers), second = LOAD(numbers + LANES);
  const Complex value = {(Real)(first.even, second.even), (Real)(first.odd, second.odd)};
#endif
  return value;
}

#if WANTED == FATHOM_COEFFICIENTS
INLINED void leave_coefficients(const Work* work, Complex f, int u, int v, bool along_row) {
  for (int i = 0; i < LANES; ++i) {
    const int row = along_row ? v : v + i, column = along_row ? u + i : u;
    // Of vectors the ends reach over what there is.
    if (row <= N / 2 && column < N) {
      work->spectrum[row * N + column] = (float2)(((const float*)&f.re)[i], ((const float*)&f.im)[i]);
    }
  }
}
#endif

// 2 N^2 F(u, v) of the rows v, v + 1, .. (or of the columns u, u + 1, .. of one row), once it has the
// grey level back.
INLINED Complex finished(const Work* work, Complex f, int u, int v, bool along_row) {
  if (abs(signed_frequency(u)) <= TOUCHED && v <= TOUCHED) {
    const Complex flat = times(complex_at(work->flat + (along_row ? u : v)),
                               work->flat[along_row ? v : u]);
    f.re += 2 * work->level * flat.re;
    f.im += 2 * work->level * flat.im;
  }
#if WANTED == FATHOM_COEFFICIENTS
  leave_coefficients(work, f, u, v, along_row);
#endif
  return f;
}

// SUM mass (u^2 + v^2) over this thread's part of the rows v > 0.
INLINED Mass row_moment(const Work* work, const Line* z, int v) {
  Mass row = {0, 0}, moment = {0, 0};
  UNROLL for (int block = 0; block < POINTS; block += BLOCK) {
    Mass part = {0, 0}, part_moment = {0, 0};
    UNROLL for (int p = block; p < block + BLOCK; ++p) {
      const int u = frequency(p);
      const Mass m = mass(finished(work, at(z, p), u, v, false));
      add(&part, m, 1);
      add(&part_moment, m, (float)(signed_frequency(u) * signed_frequency(u)));
    }
    add(&row, part, 1);
    add(&moment, part_moment, 1);
  }
  const Int rows = lanes_from(v);
  add(&moment, row, TO_REAL(rows * rows));
  moment.mass = select(moment.mass, (Real)0, rows == 0);
  moment.inverse = select(moment.inverse, (Real)0, rows == 0);
  return moment;
}

// The rows v = 0 and v = N/2 are their own mirror images: half of each counts. Line 0 has them as
// one, and leaves it in the pool: [2][N + 1], and in the last place the first again.
INLINED void leave_mirror_rows(const Work* work, const Line* z, int line) {
  everybody();
  if (line == 0) {
    UNROLL for (int c = 0; c < 2; ++c) {
      UNROLL for (int p = 0; p < POINTS; ++p) {
        const int u = frequency(p);
        const float first = ((const float*)&z->part[c][p])[0];
        work->pool[c * (N + 1) + u] = first;
        if (u == 0) work->pool[c * (N + 1) + N] = first;
      }
    }
  }
  everybody();
}

// Of pairs of coefficients u and -u, u + 1 and -u - 1, .. of both rows; every thread takes some.
typedef struct {
  Mass first, last;  // of v = 0 and v = N/2
  Real pairs;        // how often they count
} MirrorMasses;

INLINED MirrorMasses mirror_masses(const Work* work, int u) {
  const __local float* const re = work->pool + u;
  const __local float* const mirror = work->pool + N - u - (LANES - 1);
  const Complex p = {LOAD(re), LOAD(re + N + 1)};
  const Complex q = {reversed_lanes(LOAD(mirror)), reversed_lanes(LOAD(mirror + N + 1))};
  const Complex first = {p.re + q.re, p.im - q.im}, last = {p.im + q.im, q.re - p.re};
  const Int us = lanes_from(u);
  const Real is_single = select((Real)1, (Real)0.5f, us == 0 || us == N / 2);
  const MirrorMasses masses = {mass(finished(work, first, u, 0, true)),
                               mass(finished(work, last, u, N / 2, true)),
                               select(is_single, (Real)0, us > N / 2)};
  return masses;
}

#if RINGS > 0
#include "fft_rings.clh"
#else
INLINED Mass mirror_rows_moment(const Work* work, const Line* z, int line) {
  leave_mirror_rows(work, z, line);
  Mass moment = {0, 0};
  for (int u = member() * LANES; u <= N / 2; u += THREADS * LANES) {
    const MirrorMasses m = mirror_masses(work, u);
    const Int us = lanes_from(u);
    const Real arm = TO_REAL(us * us);
    add(&moment, m.first, m.pairs * arm);
    add(&moment, m.last, m.pairs * (arm + N * N / 4));
  }
  return moment;
}

INLINED float sum_of_lanes(Real v) {
  float sum = 0;
  for (int i = 0; i < LANES; ++i) sum += ((const float*)&v)[i];
  return sum;
}

// The sums of the team's values, for its first member; in one order, whatever shares the workgroup.
INLINED float3 team_sum(const Work* work, float3 value) {
  __local float* const mine = work->pool + 3 * member();
  everybody();
  mine[0] = value.x;
  mine[1] = value.y;
  mine[2] = value.z;
  for (int half_way = THREADS / 2; half_way > 0; half_way /= 2) {
    everybody();
    if (member() < half_way) {
      for (int c = 0; c < 3; ++c) mine[c] += mine[3 * half_way + c];
    }
  }
  return (float3)(mine[0], mine[1], mine[2]);
}

// Whether rounding could show (docs/metrics.md, "When float is not enough"). It leaves noise of some
// 2^-24 of the contrast in every coefficient. In phase with the picture, all of it counts; of random
// phase it is a spread of the score, and what it adds to |F| for good is its square over 2 |F|: much
// where the plane is empty.
INLINED bool is_doubtful(struct ScoreArgs args, float2 moment, float energy) {
  if (energy == 0) return false;
  if (POWER) return !(energy * args.noise <= moment.x);
  const float noise = args.noise * sqrt(energy);
  const float random = 0.5f * noise * noise * moment.y + noise * args.spread;
  return !(min(noise * args.in_phase, random) <= args.tolerance * moment.x);
}

typedef struct {
  Real energy;
  Mass moment;
} Sums;

INLINED void clear_sums(const Work* work, Sums* sums) {
  sums->energy = 0;
  sums->moment.mass = sums->moment.inverse = 0;
}

// Adds the moment of one tile of rows.
INLINED void add_tile(const Work* work, Sums* sums, const Line* z, int line, bool is_first) {
  add(&sums->moment, row_moment(work, z, line), 1);
  if (is_first) add(&sums->moment, mirror_rows_moment(work, z, line), 1);
}

// The window's moment to the host, and the window to the list if it is in doubt.
INLINED void leave_scores(const Work* work, const Sums* sums, struct ScoreArgs args, uint window,
                          __global uint2* scores, __global uint* doubtful) {
  const float3 sum =
      team_sum(work, (float3)(sum_of_lanes(sums->moment.mass), sum_of_lanes(sums->moment.inverse),
                              sum_of_lanes(sums->energy)));
  if (member() > 0 || !window_is_ours(args)) return;
  scores[window] = (uint2)(as_uint(sum.x), 0);
  if (is_doubtful(args, sum.xy, sum.z)) doubtful[1 + atomic_inc(doubtful)] = window;
}
#endif

// The sums of one window.
INLINED void score_window(Work* work, Sums* sums, Picture picture) {
  Line line, spare_line;
  Line *const z = &line, *const spare = LANES > 1 ? &spare_line : &line;
  clear_sums(work, sums);
  for (int tile = 0; tile < TILES; ++tile) {
    const int l = tile * LINES + line_of_tile();
    sums->energy += load_columns(work, z, picture, l);
#if MEETS_IN_POOL
    transform_line(work, z, spare);
#else
    leave_columns(work, transform_line(work, z, spare), l);
#endif
  }
#if !MEETS_IN_POOL
  pass_on();
#endif
  for (int tile = 0; tile < TILES; ++tile) {
    const int l = tile * LINES + line_of_tile();
#if MEETS_IN_POOL
    take_rows_from_pool(work, z, l);
#else
    take_rows(work, z, l);
#endif
    separate_columns(z, l);
    const Line* const done = transform_line(work, z, spare);
    add_tile(work, sums, done, l, tile == 0);
  }
}

__kernel __attribute__((reqd_work_group_size(WORKGROUP, 1, 1)))
void fft(__global const uint* frame, __global const uint* window_origins, __global uint2* scores,
         __global const float* tables, __global float* scratch, __global uint* doubtful,
         __global float2* spectrum, struct ScoreArgs given) {
  const struct ScoreArgs args = given;  // here, where control has not yet gone apart
  __local float pool[POOL * TEAMS];
#if RINGS > 0
  __local float2 alone[LANES > 1 ? RING_SLOTS : 1];
#endif
#if ON_CHIP
  __local float scratch_here[2 * SCRATCH_PLANE];
#else
  __global float* const scratch_here = scratch + (ulong)get_group_id(0) * (2 * SCRATCH_PLANE);
#endif
  const uint window = window_index(args);
  const Picture picture = picture_at(frame, window_origins[window], args);
  const uint grey = grey_level(picture);
  Work work = {tables,
               (__global const float2*)(tables + N),
               (__global const float2*)(tables + 3 * N),
               spectrum,
               scratch_here,
               pool + team() * POOL,
               grey,
               (float)grey};
#if RINGS > 0
  work.rules = tables + 5 * N;
  work.slots = (__global const uchar*)(work.rules + 4 * RINGS);
  work.alone = alone;
#endif
  Sums sums;
  score_window(&work, &sums, picture);
  leave_scores(&work, &sums, args, window, scores, doubtful);
}
