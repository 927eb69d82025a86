// SPDX-License-Identifier: Apache-2.0
// What the integer Walsh kernels share.
#if defined(FATHOM_CPU_WALSH_INTEGER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WALSH_INTEGER_INL_H_
#undef FATHOM_CPU_WALSH_INTEGER_INL_H_
#else
#define FATHOM_CPU_WALSH_INTEGER_INL_H_
#endif

#include <complex>
#include <span>

#include "backends/cpu/pixels-inl.h"
#include "backends/cpu/wht-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

constexpr int kMiddleGrey = 128;

/// phi = S / N^6.
inline double exact_score(std::uint64_t sum, int n) {
  const double squared = static_cast<double>(n) * n;
  return static_cast<double>(sum) / (squared * squared * squared);
}

/// The mean of |W| over so many coefficients whose |N^2 W| sum to `sum`: rounded once.
inline double exact_mean(std::uint64_t sum, double coefficients, int n) {
  return static_cast<double>(sum) / (coefficients * (static_cast<double>(n) * n));
}

/// The mean of |W| in each ring; within[k] is SUM |N^2 W| within edge k, modulo 2^64 or less.
template <class Sum>
void ring_means(const RingTables& rings, const Sum* within, int n, double* values) {
  for (int k = 0; k < rings.count; ++k) {
    const auto sum = static_cast<Sum>(within[k + 1] - within[k]);
    values[k] = exact_mean(sum, rings.coefficients[k], n);
  }
}

/// Pixels less kMiddleGrey, one per 16-bit lane: flipping the highest bit makes them signed.
template <class D>
HWY_INLINE HWY_ATTR Vec<D> about_middle(D d, const std::uint8_t* pixels) {
  const hn::Rebind<std::uint8_t, D> d_pixel;
  const auto flipped = hn::Xor(hn::LoadU(d_pixel, pixels), hn::Set(d_pixel, std::uint8_t{0x80}));
  return hn::PromoteTo(d, hn::BitCast(hn::Rebind<std::int8_t, D>(), flipped));
}

/// SUM over pairs of lanes of a * weight, in 64 bits. The sum of two neighbours must fit 32 bits
/// where all weights are equal.
template <class D>
HWY_INLINE HWY_ATTR auto weighted_sum(D d, Vec<D> a, std::int32_t weight) {
  const hn::Repartition<std::uint64_t, D> d64;
  const hn::Repartition<std::uint32_t, D> du;
  const auto pairs = hn::BitCast(d64, a);
  const auto sums = hn::Add(hn::BitCast(du, pairs), hn::BitCast(du, hn::ShiftRight<32>(pairs)));
  (void)d;
  return hn::MulEven(sums, hn::Set(du, static_cast<std::uint32_t>(weight)));
}

/// The same with a weight for each lane.
template <class D>
HWY_INLINE HWY_ATTR auto weighted_sum(D d, Vec<D> a, Vec<D> weights) {
  const hn::Repartition<std::uint64_t, D> d64;
  const hn::Repartition<std::uint32_t, D> du;
  const auto odd = [&](Vec<D> v) FATHOM_LAMBDA {
    return hn::BitCast(du, hn::ShiftRight<32>(hn::BitCast(d64, v)));
  };
  (void)d;
  return hn::Add(hn::MulEven(hn::BitCast(du, a), hn::BitCast(du, weights)),
                 hn::MulEven(odd(a), odd(weights)));
}

/// [row][col] of Plan::spectrum for coefficient (i, j) by position; T(0, 0) gets back what the
/// pixels lost.
inline void place_coefficient(const WalshTables& constants, int i, int j, std::int64_t t,
                              std::span<std::complex<double>> coefficients) {
  const int n = static_cast<int>(constants.index.size());
  const std::int64_t pixels = std::int64_t{n} * n;
  if (i == 0 && j == 0) t += kMiddleGrey * pixels;
  coefficients[static_cast<std::size_t>(constants.index[i]) * n + constants.index[j]] =
      static_cast<double>(t) / static_cast<double>(pixels);
}

/// Sums and differences of neighbouring 16-bit lanes, in 32 bits: a stage that widens.
template <class D32>
HWY_INLINE HWY_ATTR Pair<Vec<D32>> pair_up(D32 d, Vec<hn::Repartition<std::int16_t, D32>> v) {
#if HWY_TARGET <= HWY_SSE4 && HWY_ARCH_X86
  // vpmaddwd: a * 1 + b * 1, and a * 1 + b * -1.
  const auto plus = hn::Set(hn::Repartition<std::int16_t, D32>(), std::int16_t{1}).raw;
  const auto minus = hn::BitCast(hn::Repartition<std::int16_t, D32>(), hn::Set(d, -0xffff)).raw;
  if constexpr (kLanes<D32> == 4) {
    return {Vec<D32>{_mm_madd_epi16(v.raw, plus)}, Vec<D32>{_mm_madd_epi16(v.raw, minus)}};
  }
#if HWY_TARGET <= HWY_AVX2
  if constexpr (kLanes<D32> == 8) {
    return {Vec<D32>{_mm256_madd_epi16(v.raw, plus)}, Vec<D32>{_mm256_madd_epi16(v.raw, minus)}};
  }
#endif
#if HWY_TARGET <= HWY_AVX3
  if constexpr (kLanes<D32> == 16) {
    return {Vec<D32>{_mm512_madd_epi16(v.raw, plus)}, Vec<D32>{_mm512_madd_epi16(v.raw, minus)}};
  }
#endif
#else
  const auto wide = hn::BitCast(d, v);
  const auto a = hn::ShiftRight<16>(hn::ShiftLeft<16>(wide)), b = hn::ShiftRight<16>(wide);
  return {hn::Add(a, b), hn::Sub(a, b)};
#endif
}

/// Sums and differences of neighbouring pixels, in 16 bits.
template <class D16>
HWY_INLINE HWY_ATTR Pair<Vec<D16>> pair_up_pixels(D16 d,
                                                  Vec<hn::Repartition<std::uint8_t, D16>> v) {
#if HWY_TARGET <= HWY_SSE4 && HWY_ARCH_X86
  // vpmaddubsw, with weights 1, 1 and 1, -1.
  const auto plus = hn::Set(d, std::int16_t{0x0101}).raw;
  const auto minus = hn::Set(d, static_cast<std::int16_t>(0xff01)).raw;
  if constexpr (kLanes<D16> == 8) {
    return {Vec<D16>{_mm_maddubs_epi16(v.raw, plus)}, Vec<D16>{_mm_maddubs_epi16(v.raw, minus)}};
  }
#if HWY_TARGET <= HWY_AVX2
  if constexpr (kLanes<D16> == 16) {
    return {Vec<D16>{_mm256_maddubs_epi16(v.raw, plus)},
            Vec<D16>{_mm256_maddubs_epi16(v.raw, minus)}};
  }
#endif
#if HWY_TARGET <= HWY_AVX3
  if constexpr (kLanes<D16> == 32) {
    return {Vec<D16>{_mm512_maddubs_epi16(v.raw, plus)},
            Vec<D16>{_mm512_maddubs_epi16(v.raw, minus)}};
  }
#endif
#else
  const auto wide = hn::BitCast(d, v);
  const auto a = hn::And(wide, hn::Set(d, std::int16_t{0xff}));
  const auto b =
      hn::BitCast(d, hn::ShiftRight<8>(hn::BitCast(hn::Repartition<std::uint16_t, D16>(), wide)));
  return {hn::Add(a, b), hn::Sub(a, b)};
#endif
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
