// SPDX-License-Identifier: Apache-2.0
// Vocabulary of the kernels, compiled once per instruction set: loops that are surely unrolled, and
// the turn, which swaps lanes and registers.
#if defined(FATHOM_CPU_SIMD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_SIMD_INL_H_
#undef FATHOM_CPU_SIMD_INL_H_
#else
#define FATHOM_CPU_SIMD_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

// Everything in a kernel must end up in one function: a lambda or helper that is called rather than
// inlined would pass its vectors through memory.
#define FATHOM_LAMBDA HWY_ATTR __attribute__((always_inline))

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using Vec = hn::Vec<D>;

/// Lanes of a tag; a constant, because no instruction set here has vectors of unknown length.
template <class D>
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));

/// a + b and a - b.
template <class V>
struct Pair {
  V sum, difference;
};

template <int kCount, class Body, std::size_t... kIndex>
HWY_INLINE HWY_ATTR void unroll_over(const Body& body, std::index_sequence<kIndex...>) {
  (body(std::integral_constant<int, static_cast<int>(kIndex)>()), ...);
}

/// body(0), body(1), .. body(kCount - 1), each index a constant.
template <int kCount, class Body>
HWY_INLINE HWY_ATTR void unroll(const Body& body) {
  unroll_over<kCount>(body, std::make_index_sequence<kCount>());
}

/// Of two vectors of 128-bit blocks: a's blocks 0, 2, .. and then b's.
template <class D>
HWY_INLINE HWY_ATTR Vec<D> even_blocks(D d, Vec<D> a, Vec<D> b) {
  constexpr int blocks = kLanes<D> * sizeof(hn::TFromD<D>) / 16;
#if HWY_TARGET <= HWY_AVX3
  if constexpr (blocks == 4) {
    const hn::Repartition<std::int32_t, D> d32;
    return hn::BitCast(d, hn::Vec<decltype(d32)>{_mm512_shuffle_i32x4(
                              hn::BitCast(d32, a).raw, hn::BitCast(d32, b).raw, 0x88)});
  } else
#endif
  {
    static_assert(blocks == 2);
    return hn::ConcatLowerLower(d, b, a);
  }
}

/// The same of blocks 1, 3, ..
template <class D>
HWY_INLINE HWY_ATTR Vec<D> odd_blocks(D d, Vec<D> a, Vec<D> b) {
  constexpr int blocks = kLanes<D> * sizeof(hn::TFromD<D>) / 16;
#if HWY_TARGET <= HWY_AVX3
  if constexpr (blocks == 4) {
    const hn::Repartition<std::int32_t, D> d32;
    return hn::BitCast(d, hn::Vec<decltype(d32)>{_mm512_shuffle_i32x4(
                              hn::BitCast(d32, a).raw, hn::BitCast(d32, b).raw, 0xdd)});
  } else
#endif
  {
    static_assert(blocks == 2);
    return hn::ConcatUpperUpper(d, b, a);
  }
}

/// One step of the turn inside 128-bit blocks: pairs of registers `kStep` apart exchange the
/// elements of `Wide` bits.
template <class Wide, int kRows, int kStep, class D>
HWY_INLINE HWY_ATTR void turn_step(D d, Vec<D> (&v)[kRows]) {
  const hn::Repartition<Wide, D> dw;
  unroll<kRows / 2>([&](auto pair) FATHOM_LAMBDA {
    constexpr int i = (pair / kStep) * 2 * kStep + pair % kStep;
    const auto a = hn::BitCast(dw, v[i]);
    const auto b = hn::BitCast(dw, v[i + kStep]);
    v[i] = hn::BitCast(d, hn::InterleaveLower(dw, a, b));
    v[i + kStep] = hn::BitCast(d, hn::InterleaveUpper(dw, a, b));
  });
}

template <int kRows, int kStep, class D>
HWY_INLINE HWY_ATTR void turn_blocks_step(D d, Vec<D> (&v)[kRows]) {
  unroll<kRows / 2>([&](auto pair) FATHOM_LAMBDA {
    constexpr int i = (pair / kStep) * 2 * kStep + pair % kStep;
    const auto a = v[i];
    const auto b = v[i + kStep];
    v[i] = even_blocks(d, a, b);
    v[i + kStep] = odd_blocks(d, a, b);
  });
}

/// The lowest bits of a number in reverse order.
constexpr int reversed_bits(int number, int bits) {
  int reversed = 0;
  for (int bit = 0; bit < bits; ++bit) reversed = 2 * reversed + (number >> bit & 1);
  return reversed;
}

/// The column that register r holds after turn(): two steps inside 128-bit blocks of 32-bit lanes
/// leave their two bits in reverse order.
template <class D>
constexpr int turned_column(int r) {
  return sizeof(hn::TFromD<D>) == 4 ? (r & ~3) | reversed_bits(r & 3, 2) : r;
}

/// Turns a square: column c, lane c of all registers, becomes the register r with turned_column(r)
/// = c. Each of the log2(lanes) steps swaps one bit of the lane's number with one of the
/// register's.
template <class D>
HWY_INLINE HWY_ATTR void turn(D d, Vec<D> (&v)[kLanes<D>]) {
  using T = hn::TFromD<D>;
  constexpr int lanes = kLanes<D>;
  constexpr int blocks = lanes * sizeof(T) / 16;
  if constexpr (sizeof(T) == 4) {
    turn_step<std::uint32_t, lanes, 1>(d, v);
    turn_step<std::uint64_t, lanes, 2>(d, v);
  } else {
    static_assert(sizeof(T) == 8);
    turn_step<std::uint64_t, lanes, 1>(d, v);
  }
  constexpr int in_block = 16 / sizeof(T);
  if constexpr (blocks >= 2) turn_blocks_step<lanes, in_block>(d, v);
  if constexpr (blocks >= 4) turn_blocks_step<lanes, 2 * in_block>(d, v);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
