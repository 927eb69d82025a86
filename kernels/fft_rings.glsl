// SPDX-License-Identifier: Apache-2.0
// The rings of fft.comp, which includes this after what leads to the masses: sums by ring, and
// whether float was enough for them.

// The register that holds the i-th of this thread's frequencies, from 0 to N - 1.
int register_of(int i) {
  if (SPLIT == 1) return reversed_bits(i, POINTS);
  const int run = POINTS / SPLIT;
  return i % run * SPLIT + reversed_bits(i / run, SPLIT);
}

int ring_slot(int u, int v) { return ring_byte(min(u, N - u) * RING_PITCH + v); }

// One over |f|, if the coefficient is in a ring.
float inverse_in(int slot, vec2 mass) { return slot < RINGS ? mass.y : 0; }

// Masses of this thread's part of the rows v = 0 and v = N/2; returns the sum of their inverses.
float add_mirror_rows_to_rings(float grey) {
  float inverses = 0;
  for (int u = member(); u <= N / 2; u += THREADS) {
    const MirrorMasses m = mirror_masses(u, grey);
    const int first = ring_slot(u, 0), last = ring_slot(u, N / 2);
    add_to_slot(first, m.first.x);
    add_to_slot(last, m.last.x);
    inverses += inverse_in(first, m.first) + inverse_in(last, m.last);
  }
  return inverses;
}

// The same of row v. As u grows, neighbours are in one ring: it is a run that goes to a slot.
float add_row_to_rings(int v, float grey) {
  float run = 0, inverses = 0;
  int slot = ring_slot(frequency(register_of(0)), v);
  [[unroll]] for (int i = 0; i < POINTS; ++i) {
    const int p = register_of(i), u = frequency(p), next = ring_slot(u, v);
    const vec2 m = mass(z[p], u, v, grey);
    if (next != slot) {
      add_to_slot(slot, run);
      slot = next;
      run = 0;
    }
    run += m.x;
    inverses += inverse_in(slot, m);
  }
  add_to_slot(slot, run);
  return inverses;
}

// Every member has some of the team's sums: slots member, member + THREADS, ..
const int SUMS_OF_MEMBER = (RINGS + 2 + THREADS - 1) / THREADS;
float ring_sums[SUMS_OF_MEMBER];

// Level that the weighted mean is above what was subtracted: row 0 in the pool says so.
float mean_above() {
  const float at_zero = pool[team() * POOL], of_one = flat_at(0).x;
  return at_zero / (of_one * of_one);
}

float mean;  // of the window, above the level that was subtracted from its pixels

// Adds the masses of one tile of rows to the team's sums; energy of the window, at the first tile.
void add_tile_to_rings(int line, bool is_first, float energy) {
  if (is_first) {
    leave_mirror_rows(line);
    mean = mean_above();
  } else {
    barrier();
  }
  clear_slots();
  float inverses = 0;
  // What the level adds to a spectrum stays out, and with it what is left of the mean.
  if (is_first) inverses += add_mirror_rows_to_rings(-mean);
  if (line > 0) inverses += add_row_to_rings(line, -mean);
  to_pool(slot_at(SLOT_OF_INVERSES), inverses);
  to_pool(slot_at(SLOT_OF_ENERGY), energy);
  gather_slots(RINGS + 2);
  [[unroll]] for (int i = 0; i < SUMS_OF_MEMBER; ++i) {
    const int slot = member() + i * THREADS;
    if (slot < RINGS + 2) ring_sums[i] += from_pool(slot_of_member(slot, 0));
  }
}

// As is_doubtful, of the mean of one ring (docs/metrics.md, "Rings in float"). The host knows how
// far noise in phase with the picture moves the ring's sum, how far noise of random phase does, and
// what may be off in an empty ring.
bool ring_is_doubtful(int ring, float sum, float inverses, float energy) {
  if (energy == 0) return false;
  const int rule = RING_RULES + 4 * ring;
  const float noise = args.noise * sqrt(energy), brightness = abs(mean) * tables[rule + 3];
  const float root = sqrt(sum);
  const float error =
      POWER ? noise * (tables[rule] * root + noise * tables[rule + 1]) +
                  brightness * (2 * root + 2 * brightness)
            : noise * min(tables[rule], 0.5 * noise * inverses + tables[rule + 1]) + brightness;
  return !(error <= args.tolerance * (sum + tables[rule + 2]));
}

// The window's sums to the host, and the window to the list if one of them is in doubt.
void leave_rings(uint window) {
  const int base = team() * POOL;
  barrier();
  [[unroll]] for (int i = 0; i < SUMS_OF_MEMBER; ++i) {
    const int slot = member() + i * THREADS;
    if (slot < RINGS + 2) pool[base + slot] = ring_sums[i];
  }
  barrier();
  const float inverses = pool[base + SLOT_OF_INVERSES], energy = pool[base + SLOT_OF_ENERGY];
  float doubts = 0;
  for (int ring = member(); ring < RINGS; ring += THREADS) {
    const float sum = pool[base + ring];
    if (window_is_ours()) values[window * RINGS + ring] = floatBitsToUint(sum);
    if (ring_is_doubtful(ring, sum, inverses, energy)) doubts += 1;
  }
  barrier();
  pool[base + member()] = doubts;
  barrier();
  if (member() > 0 || !window_is_ours()) return;
  for (int i = 1; i < min(RINGS, THREADS); ++i) doubts += pool[base + i];
  if (doubts > 0) doubtful[atomicAdd(doubtful_count, 1)] = window;
}
