// SPDX-License-Identifier: Apache-2.0
// One-dimensional Walsh-Hadamard transforms, one per lane, in Hadamard order: N points are N
// registers, or what is left of them in the first-level cache between two stages.
#if defined(FATHOM_CPU_WHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WHT_INL_H_
#undef FATHOM_CPU_WHT_INL_H_
#else
#define FATHOM_CPU_WHT_INL_H_
#endif

#include "backends/cpu/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

/// One stage: sums and differences of registers kDistance apart.
template <int kDistance, int R, class D>
HWY_INLINE HWY_ATTR void wht_stage(D, Vec<D> (&x)[R]) {
  unroll<R / 2>([&](auto pair) FATHOM_LAMBDA {
    constexpr int r = pair / kDistance * 2 * kDistance + pair % kDistance;
    const auto a = x[r], b = x[r + kDistance];
    x[r] = hn::Add(a, b);
    x[r + kDistance] = hn::Sub(a, b);
  });
}

/// T(i) = SUM x(k) (-1)^(bits that i and k share), in place: log2 R stages of sums and differences.
template <int R, class D>
HWY_INLINE HWY_ATTR void small_wht(D d, Vec<D> (&x)[R]) {
  static_assert(R == 2 || R == 4 || R == 8 || R == 16);
  if constexpr (R >= 16) wht_stage<8>(d, x);
  if constexpr (R >= 8) wht_stage<4>(d, x);
  if constexpr (R >= 4) wht_stage<2>(d, x);
  wht_stage<1>(d, x);
}

/// The transform of N points per lane. load(k) gives point k, and may read the column itself;
/// consume(p, T) takes coefficients p .. p+R-1. column: scratch memory of N registers.
template <int N, class D, class Load, class Consume>
HWY_INLINE HWY_ATTR void wht(D d, hn::TFromD<D>* HWY_RESTRICT column, const Load& load,
                             const Consume& consume) {
  if constexpr (N <= 16) {
    Vec<D> x[N];
    unroll<N>([&](auto r) FATHOM_LAMBDA { x[r] = load(static_cast<int>(r)); });
    small_wht<N>(d, x);
    consume(0, x);
  } else {
    // N = first * middle * last: each factor is one trip through the cache. The last one is always
    // 8, because the strips of integers turn what is consumed, eight rows by eight columns.
    constexpr int last = 8;
    constexpr int first = N == 32 || N == 256 ? 4 : N == 128 ? 16 : 8;
    constexpr int middle = N / (first * last);
    constexpr int step = N / first;
    // Points eight apart one after the other: the strips of large windows keep those side by side.
    constexpr int apart = step < 8 ? step : 8;
    for (int start = 0; start < apart; ++start) {
      for (int s = start; s < step; s += apart) {
        Vec<D> x[first];
        unroll<first>([&](auto r) FATHOM_LAMBDA { x[r] = load(s + r * step); });
        small_wht<first>(d, x);
        unroll<first>(
            [&](auto r) FATHOM_LAMBDA { hn::Store(x[r], d, column + (s + r * step) * kLanes<D>); });
      }
    }
    // One part after the other, so that it stays in the first-level cache to the end.
    for (int part = 0; part < N; part += step) {
      if constexpr (middle > 1) {
        for (int s = part; s < part + last; ++s) {
          Vec<D> x[middle];
          unroll<middle>([&](auto r) FATHOM_LAMBDA {
            x[r] = hn::Load(d, column + (s + r * last) * kLanes<D>);
          });
          small_wht<middle>(d, x);
          unroll<middle>([&](auto r) FATHOM_LAMBDA {
            hn::Store(x[r], d, column + (s + r * last) * kLanes<D>);
          });
        }
      }
      for (int p = part; p < part + step; p += last) {
        Vec<D> x[last];
        unroll<last>([&](auto r)
                         FATHOM_LAMBDA { x[r] = hn::Load(d, column + (p + r) * kLanes<D>); });
        small_wht<last>(d, x);
        consume(p, x);
      }
    }
  }
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
