// SPDX-License-Identifier: Apache-2.0
// The rings of walsh.comp, which includes this after what leads to the masses: sums by ring.

// Where register q, part c, of the rows v and v + N/2 goes.
int ring_slot(int v, int q, int c) {
  const int i = v + q / (POINTS / 2) * (N / 2), j = position(q % (POINTS / 2)) + c * N / 2;
  return ring_byte(j * N + i);
}

// Every member has some of the team's sums: rings member, member + THREADS, ..
const int SUMS_OF_MEMBER = (RINGS + THREADS) / THREADS;
uvec2 ring_sums[SUMS_OF_MEMBER];  // 64 bits: low word, high word; with POWER a float in the low one

// SUM W^2 in each ring over a tile of rows.
void add_tile_to_ring_powers(int v) {
  barrier();
  clear_slots();
  [[unroll]] for (int q = 0; q < POINTS; ++q) {
    [[unroll]] for (int c = 0; c < 2; ++c) {
      const float w = as_float(magnitude(q, c));
      add_to_slot(ring_slot(v, q, c), w * w);
    }
  }
  gather_slots(RINGS);
  [[unroll]] for (int i = 0; i < SUMS_OF_MEMBER; ++i) {
    const int ring = member() + i * THREADS;
    if (ring < RINGS) {
      const float sum = uintBitsToFloat(ring_sums[i].x) + from_pool(slot_of_member(ring, 0));
      ring_sums[i].x = floatBitsToUint(sum);
    }
  }
}

// SUM |W|, limb after limb: a thread's sum of 2 POINTS limbs fits a word, and halves of words, of
// all threads, fit one again. Whole numbers may be added in any order, so all members add at once.
void add_tile_to_ring_magnitudes(int v) {
  const int limbs = team() * POOL + RING_LIMBS_START;
  barrier();
  for (int i = member(); i < 3 * RINGS; i += THREADS) pool[limbs + i] = 0;
  [[unroll]] for (int l = 0; l < LIMBS; ++l) {
    clear_slots();
    [[unroll]] for (int q = 0; q < POINTS; ++q) {
      [[unroll]] for (int c = 0; c < 2; ++c) {
        pool[slot_at(ring_slot(v, q, c))] += limb(magnitude(q, c) - NOTHING, l);
      }
    }
    barrier();
    for (int k = 0; k < RINGS; ++k) {
      const int ring = (k + member()) % RINGS;  // or all would wait for one word
      const uint sum = pool[slot_at(ring)];
      atomicAdd(pool[limbs + 3 * ring + l], sum & 0xffffu);
      atomicAdd(pool[limbs + 3 * ring + l + 1], sum >> 16);
    }
  }
  barrier();
  [[unroll]] for (int i = 0; i < SUMS_OF_MEMBER; ++i) {
    const int ring = member() + i * THREADS;
    if (ring < RINGS) {
      const int at = limbs + 3 * ring;
      const uint middle = pool[at + 1];
      const uvec2 sum = add(uvec2(pool[at], pool[at + 2]), uvec2(middle << 16, middle >> 16));
      ring_sums[i] = add(ring_sums[i], sum);
    }
  }
}

void add_tile_to_rings(int v) {
  if (POWER) {
    add_tile_to_ring_powers(v);
  } else {
    add_tile_to_ring_magnitudes(v);
  }
}

void leave_rings(uint window) {
  if (!window_is_ours()) return;
  [[unroll]] for (int i = 0; i < SUMS_OF_MEMBER; ++i) {
    const int ring = member() + i * THREADS;
    if (ring < RINGS) {
      const uint at = window * RINGS + ring;
      if (POWER) {
        values[at] = ring_sums[i].x;
      } else {
        values[2 * at] = ring_sums[i].x;
        values[2 * at + 1] = ring_sums[i].y;
      }
    }
  }
}
