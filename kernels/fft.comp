#version 450
// SPDX-License-Identifier: Apache-2.0
// Focus quality by the Fourier transform, from pixels to one number per window (thesis eqs. 3-10,
// 5-1), or to one for each of its RINGS, in single precision; windows that it is not enough for are
// listed for exact.comp.
//
// What is summed is 2 N^2 F of half of the plane, which has the mass of all of it twice over; the
// host multiplies by the factors that are left. Two real columns are one complex line:
//
//   z = a + i b,   2A(v) = Z(v) + conj Z(-v),   2B(v) = -i (Z(v) - conj Z(-v))
//
// and the rows v = 0 and v = N/2, real both as columns come out of them, are one complex line too,
// line 0 of the second pass.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "window.glsl"

layout(constant_id = FATHOM_TOUCHED) const int TOUCHED = 1;

// float[N] taper, vec2[N] N W(k) (the transform of a constant 1 under the taper), vec2[N] roots of
// unity exp(-2 pi i k/N). Of rings: float[RINGS][4] what ring_is_doubtful knows of each, then bytes
// [|u|][|v|], which slot the coefficient goes to, in rows of RING_PITCH.
layout(binding = FATHOM_BINDING_WORK) readonly buffer Tables { float tables[]; };
layout(binding = FATHOM_BINDING_WORK) coherent buffer Scratch { vec2 scratch[]; };
layout(binding = FATHOM_BINDING_RESULTS) writeonly buffer Spectrum { vec2 spectrum[]; };
layout(binding = FATHOM_BINDING_DOUBTFUL) buffer Doubtful { uint doubtful_count; uint doubtful[]; };

float taper(int x) { return tables[x]; }
vec2 flat_at(int k) { return vec2(tables[N + 2 * k], tables[N + 2 * k + 1]); }
vec2 root_of_n(int k) { return vec2(tables[3 * N + 2 * k], tables[3 * N + 2 * k + 1]); }

const int RING_RULES = 5 * N;
const int RING_TABLE = RING_RULES + 4 * RINGS;
const int RING_PITCH = N / 2 + FATHOM_RING_MARGIN;
// Beside the rings the sums of 1/|f| and of the energy, and what lies in no ring.
const int SLOT_OF_INVERSES = RINGS, SLOT_OF_ENERGY = RINGS + 1, RING_SLOTS = RINGS + 3;
const int RING_SLOTS_START = 2 * N;
const int SUMMED = RING_SLOTS_START + RING_SLOTS * THREADS;
const int POOL = RINGS > 0 && SUMMED > EXCHANGE ? SUMMED : EXCHANGE;  // a team's part
shared float pool[POOL * TEAMS];

float from_pool(int at) { return pool[at]; }
void to_pool(int at, float number) { pool[at] = number; }
#include "rings.glsl"

vec2 z[POINTS];  // this thread's part of its line

vec2 times(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }

// exp(-2 pi i k/64), k = 0 .. 31.
vec2 ROOT[32] = vec2[](
  vec2(1.0, 0.0), vec2(0.99518472667219693, -0.098017140329560604),
  vec2(0.98078528040323043, -0.19509032201612825), vec2(0.95694033573220882, -0.29028467725446233),
  vec2(0.92387953251128674, -0.38268343236508977), vec2(0.88192126434835505, -0.47139673682599764),
  vec2(0.83146961230254524, -0.55557023301960218), vec2(0.77301045336273699, -0.63439328416364549),
  vec2(0.70710678118654757, -0.70710678118654757), vec2(0.63439328416364549, -0.77301045336273699),
  vec2(0.55557023301960218, -0.83146961230254524), vec2(0.47139673682599764, -0.88192126434835505),
  vec2(0.38268343236508977, -0.92387953251128674), vec2(0.29028467725446233, -0.95694033573220882),
  vec2(0.19509032201612825, -0.98078528040323043), vec2(0.098017140329560604, -0.99518472667219693),
  vec2(0.0, -1.0), vec2(-0.098017140329560604, -0.99518472667219693),
  vec2(-0.19509032201612825, -0.98078528040323043), vec2(-0.29028467725446233, -0.95694033573220882),
  vec2(-0.38268343236508977, -0.92387953251128674), vec2(-0.47139673682599764, -0.88192126434835505),
  vec2(-0.55557023301960218, -0.83146961230254524), vec2(-0.63439328416364549, -0.77301045336273699),
  vec2(-0.70710678118654757, -0.70710678118654757), vec2(-0.77301045336273699, -0.63439328416364549),
  vec2(-0.83146961230254524, -0.55557023301960218), vec2(-0.88192126434835505, -0.47139673682599764),
  vec2(-0.92387953251128674, -0.38268343236508977), vec2(-0.95694033573220882, -0.29028467725446233),
  vec2(-0.98078528040323043, -0.19509032201612825), vec2(-0.99518472667219693, -0.098017140329560604));

// Transforms each run of `points` registers by decimation in frequency; frequencies come out in
// the order of reversed bits.
void transform_registers(int points) {
  [[unroll]] for (int stage = 0; (2 << stage) <= points; ++stage) {
    const int span = points >> (stage + 1);
    [[unroll]] for (int i = 0; i < POINTS / 2; ++i) {
      const int r = i % span, upper = (i / span) * 2 * span + r, lower = upper + span;
      const vec2 sum = z[upper] + z[lower], difference = z[upper] - z[lower];
      z[upper] = sum;
      if (r == 0) {
        z[lower] = difference;
      } else if (2 * r == span) {
        z[lower] = vec2(difference.y, -difference.x);
      } else {
        z[lower] = times(difference, ROOT[r * (32 / span)]);
      }
    }
  }
}

// The frequency that register p holds after transform_line.
int frequency(int p) {
  if (SPLIT == 1) return reversed_bits(p, POINTS);
  return part_of_line() + SPLIT * (p / SPLIT) + POINTS * reversed_bits(p % SPLIT, SPLIT);
}

// The transform of a line whose sample part + SPLIT a is register a. Where threads share the line:
// over a first, giving frequency k1, a turn by exp(-2 pi i part k1/N), then over the parts.
void transform_line() {
  transform_registers(POINTS);
  if (SPLIT == 1) return;
  const int line = line_of_tile(), part = part_of_line(), base = team() * POOL;
  [[unroll]] for (int p = 1; p < POINTS; ++p) {
    z[p] = times(z[p], root_of_n(part * reversed_bits(p, POINTS)));
  }
  [[unroll]] for (int c = 0; c < 2; ++c) {
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      pool[base + (reversed_bits(p, POINTS) * SPLIT + part) * PITCH + line] = z[p][c];
    }
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      const int k1 = part + SPLIT * (p / SPLIT);
      z[p][c] = pool[base + (k1 * SPLIT + p % SPLIT) * PITCH + line];
    }
  }
  transform_registers(SPLIT);
}

// A grey level near the mean: what is common to all pixels is left out of the sums and put back at
// the end, or its rounding would drown a faint picture. The mean of eight pixels on a lattice, whole.
uint grey_level(uint origin) {
  uint sum = 0;
  for (int k = 0; k < 8; ++k) {
    const Column column = column_at(origin, (2 * k + 1) * N / 16);
    sum += pixel(column, (2 * (3 * k % 8) + 1) * N / 16);
  }
  return sum / 8;
}

// Columns l and l + N/2, tapered; returns the sum of their squares.
float load_columns(uint origin, int l, uint grey) {
  const Column left = column_at(origin, l), right = column_at(origin, l + N / 2);
  const vec2 tapers = vec2(taper(l), taper(l + N / 2));
  float energy = 0;
  [[unroll]] for (int a = 0; a < POINTS; ++a) {
    const int y = part_of_line() + SPLIT * a;
    const vec2 f = vec2(level_above(pixel(left, y), grey), level_above(pixel(right, y), grey));
    z[a] = f * tapers * taper(y);
    energy += dot(z[a], z[a]);
  }
  return energy;
}

// Gives up the line of columns; takes samples of the rows v and w of Z instead: of the lines l =
// part + SPLIT a, Z(v) in register a and Z(w) in register a + POINTS/2.
void take_rows_on_chip(int v, int w) {
  const int line = line_of_tile(), base = team() * POOL;
  [[unroll]] for (int c = 0; c < 2; ++c) {
    barrier();
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      pool[base + pool_at(frequency(p), line)] = z[p][c];
    }
    barrier();
    [[unroll]] for (int a = 0; a < POINTS / 2; ++a) {
      const int l = part_of_line() + SPLIT * a;
      z[a][c] = pool[base + pool_at(v, l)];
      z[a + POINTS / 2][c] = pool[base + pool_at(w, l)];
    }
  }
}

void leave_columns(int l) {
  [[unroll]] for (int p = 0; p < POINTS; ++p) scratch[scratch_at(frequency(p), l)] = z[p];
}

void take_rows(int v) {
  const int w = v == 0 ? N / 2 : N - v;
  if (TILES == 1) {
    take_rows_on_chip(v, w);
    return;
  }
  [[unroll]] for (int a = 0; a < POINTS / 2; ++a) {
    const int l = part_of_line() + SPLIT * a;
    z[a] = scratch[scratch_at(v, l)];
    z[a + POINTS / 2] = scratch[scratch_at(w, l)];
  }
}

// From rows v and -v of Z to the samples of row v, or of the rows 0 and N/2, along x.
void separate_columns(int v) {
  [[unroll]] for (int a = 0; a < POINTS / 2; ++a) {
    const vec2 p = z[a], q = z[a + POINTS / 2];
    z[a] = v == 0 ? vec2(p.x, q.x) : vec2(p.x + q.x, p.y - q.y);
    z[a + POINTS / 2] = v == 0 ? vec2(p.y, q.y) : vec2(p.y + q.y, q.x - p.x);
  }
}

int signed_frequency(int k) { return k < N / 2 ? k : k - N; }

// |f| and 1/|f|, or |f|^2 alone, for f = 2 N^2 F(u, v) once it has the grey level back; or nothing but
// the coefficient left where it is wanted.
vec2 mass(vec2 f, int u, int v, float grey) {
  if (abs(signed_frequency(u)) <= TOUCHED && v <= TOUCHED) {
    f += 2 * grey * times(flat_at(u), flat_at(v));
  }
  if (WANTED == FATHOM_COEFFICIENTS) spectrum[v * N + u] = f;
  const float square = dot(f, f);
  if (POWER) return vec2(square, 0);
  const float inverse = inversesqrt(max(square, 1e-30));
  return vec2(square * inverse, inverse);
}

// SUM mass (u^2 + v^2) over this thread's part of row v.
vec2 row_moment(int v, float grey) {
  vec2 row = vec2(0), moment = vec2(0);
  [[unroll]] for (int p = 0; p < POINTS; ++p) {
    const int u = frequency(p);
    const vec2 m = mass(z[p], u, v, grey);
    row += m;
    moment += m * float(signed_frequency(u) * signed_frequency(u));
  }
  return moment + row * float(v * v);
}

// The rows v = 0 and v = N/2 are their own mirror images: half of each counts. Line 0 has them as
// one, and leaves it in the pool.
void leave_mirror_rows(int line) {
  const int base = team() * POOL;
  barrier();
  if (line == 0) {
    [[unroll]] for (int p = 0; p < POINTS; ++p) {
      pool[base + 2 * frequency(p)] = z[p].x;
      pool[base + 2 * frequency(p) + 1] = z[p].y;
    }
  }
  barrier();
}

// Of the pair of coefficients u and -u of both rows; every thread takes some.
struct MirrorMasses {
  vec2 first, last;  // of v = 0 and v = N/2
};
MirrorMasses mirror_masses(int u, float grey) {
  const int base = team() * POOL, mirror = (N - u) % N;
  const vec2 p = vec2(pool[base + 2 * u], pool[base + 2 * u + 1]);
  const vec2 q = vec2(pool[base + 2 * mirror], pool[base + 2 * mirror + 1]);
  const float pairs = u % (N / 2) == 0 ? 0.5 : 1;
  return MirrorMasses(pairs * mass(vec2(p.x + q.x, p.y - q.y), u, 0, grey),
                      pairs * mass(vec2(p.y + q.y, q.x - p.x), u, N / 2, grey));
}

vec2 mirror_rows_moment(int line, float grey) {
  leave_mirror_rows(line);
  vec2 moment = vec2(0);
  for (int u = member(); u <= N / 2; u += THREADS) {
    const MirrorMasses m = mirror_masses(u, grey);
    const float arm = float(u * u);
    moment += m.first * arm + m.last * (arm + float(N * N / 4));
  }
  return moment;
}

// The sums of the team's values, for its first member; in one order, whatever shares the workgroup.
vec3 team_sum(vec3 value) {
  const int mine = team() * POOL + 3 * member();
  barrier();
  [[unroll]] for (int c = 0; c < 3; ++c) pool[mine + c] = value[c];
  for (int half_way = THREADS / 2; half_way > 0; half_way /= 2) {
    barrier();
    if (member() < half_way) {
      [[unroll]] for (int c = 0; c < 3; ++c) pool[mine + c] += pool[mine + 3 * half_way + c];
    }
  }
  return vec3(pool[mine], pool[mine + 1], pool[mine + 2]);
}

// Whether rounding could show (docs/metrics.md, "When float is not enough"). It leaves noise of some
// 2^-24 of the contrast in every coefficient. In phase with the picture, all of it counts; of random
// phase it is a spread of the score, and what it adds to |F| for good is its square over 2 |F|: much
// where the plane is empty.
bool is_doubtful(vec2 moment, float energy) {
  if (energy == 0) return false;
  if (POWER) return !(energy * args.noise <= moment.x);
  const float noise = args.noise * sqrt(energy);
  const float random = 0.5 * noise * noise * moment.y + noise * args.spread;
  return !(min(noise * args.in_phase, random) <= args.tolerance * moment.x);
}

#include "fft_rings.glsl"

void main() {
  const uint window = window_index(), origin = origin_of(window);
  const uint level = grey_level(origin);
  const float grey = float(level);
  float energy = 0;
  vec2 moment = vec2(0);
  [[unroll]] for (int i = 0; i < SUMS_OF_MEMBER; ++i) ring_sums[i] = 0;
  for (int step = 0; step < 2 * TILES; ++step) {
    const bool is_columns = step < TILES;
    const int line = step % TILES * LINES + line_of_tile();
    if (step == TILES) pass_on();
    if (is_columns) {
      energy += load_columns(origin, line, level);
    } else {
      take_rows(line);
      separate_columns(line);
    }
    transform_line();
    if (is_columns) {
      if (TILES > 1) leave_columns(line);
    } else if (RINGS > 0) {
      add_tile_to_rings(line, step == TILES, step == TILES ? energy : 0);
    } else {
      if (line > 0) moment += row_moment(line, grey);
    }
    if (RINGS == 0 && step == TILES) moment += mirror_rows_moment(line, grey);
  }
  if (RINGS > 0) {
    leave_rings(window);
    return;
  }
  const vec3 sum = team_sum(vec3(moment, energy));
  if (WANTED != FATHOM_SCORE || member() > 0 || !window_is_ours()) return;
  scores[window] = uvec2(floatBitsToUint(sum.x), 0);
  if (is_doubtful(sum.xy, sum.z)) doubtful[atomicAdd(doubtful_count, 1)] = window;
}
