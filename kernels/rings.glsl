// SPDX-License-Identifier: Apache-2.0
// Sums of masses by rings of spatial frequency instead of one moment; included by fft.comp and
// walsh.comp, which say before how they keep numbers in their pool:
//
//   RING_TABLE        word of the tables where the rings' own begin
//   RING_SLOTS        sums of one thread, a multiple of a ring's where a coefficient is in no ring
//   RING_SLOTS_START  word of a team's pool where slots begin: slot k of all members, then k + 1
//   from_pool(at), to_pool(at, number)
//
// Every thread sums for itself, and a team's sums meet in a tree of one order: the same on every
// device. RINGS is 0 where a moment is wanted, and nothing of this is left.

layout(binding = FATHOM_BINDING_WORK) readonly buffer RingTable { uint ring_words[]; };
layout(binding = FATHOM_BINDING_RESULTS) writeonly buffer Values { uint values[]; };  // [window][ring]

// A byte of a table of rings: which slot a coefficient goes to.
int ring_byte(int at) {
  return int(ring_words[RING_TABLE + at / 4] >> (8 * (at % 4)) & 0xffu);
}

int slot_of_member(int slot, int member) {
  return team() * POOL + RING_SLOTS_START + slot * THREADS + member;
}
int slot_at(int slot) { return slot_of_member(slot, member()); }

void add_to_slot(int slot, float mass) {
  const int at = slot_at(slot);
  to_pool(at, from_pool(at) + mass);
}

void clear_slots() {
  for (int slot = 0; slot < RING_SLOTS; ++slot) to_pool(slot_at(slot), 0);
}

// Sums the first `count` slots of all members, for the first member's.
void gather_slots(int count) {
  for (int level = findMSB(THREADS) - 1; level >= 0; --level) {
    const int half_way = 1 << level;
    barrier();
    for (int i = member(); i < count << level; i += THREADS) {
      const int at = slot_of_member(i >> level, i & (half_way - 1));
      to_pool(at, from_pool(at) + from_pool(at + half_way));
    }
  }
  barrier();
}
