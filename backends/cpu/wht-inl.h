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

/// T(i) = SUM x(k) (-1)^(bits that i and k share), in place: log2 R stages of sums and differences.
template <int R, class D>
HWY_INLINE HWY_ATTR void small_wht(D d, Vec<D> (&x)[R]) {
  if constexpr (R >= 2) {
    unroll<R / 2>([&](auto i) FATHOM_LAMBDA {
      const auto a = x[i], b = x[i + R / 2];
      x[i] = hn::Add(a, b);
      x[i + R / 2] = hn::Sub(a, b);
    });
  }
  if constexpr (R >= 4) {
    // The two halves are transforms of half the size; written so that both stay in registers.
    Vec<D> lower[R / 2], upper[R / 2];
    unroll<R / 2>([&](auto i) FATHOM_LAMBDA { lower[i] = x[i], upper[i] = x[i + R / 2]; });
    small_wht<R / 2>(d, lower);
    small_wht<R / 2>(d, upper);
    unroll<R / 2>([&](auto i) FATHOM_LAMBDA { x[i] = lower[i], x[i + R / 2] = upper[i]; });
  }
}

/// The transform of N points per lane. load(k) gives point k, and may read the column itself;
/// consume(p, T) takes coefficients p .. p+R-1. column: scratch memory of N registers.
template <int N, class D, class Load, class Consume>
HWY_INLINE HWY_ATTR void wht(D d, hn::TFromD<D>* HWY_RESTRICT column, const Load& load,
                             const Consume& consume) {
  constexpr int L = kLanes<D>;
  if constexpr (N <= 16) {
    Vec<D> x[N];
    unroll<N>([&](auto r) FATHOM_LAMBDA { x[r] = load(static_cast<int>(r)); });
    small_wht<N>(d, x);
    consume(0, x);
  } else {
    // N = first * middle * last: each factor is one trip through the cache. The last one is
    // always 8.
    constexpr int last = 8;
    constexpr int first = N == 32 || N == 256 ? 4 : N == 128 ? 16 : 8;
    constexpr int middle = N / (first * last);
    constexpr int step = N / first;
    for (int s = 0; s < step; ++s) {
      Vec<D> x[first];
      unroll<first>([&](auto r) FATHOM_LAMBDA { x[r] = load(s + r * step); });
      small_wht<first>(d, x);
      unroll<first>([&](auto r) FATHOM_LAMBDA { hn::Store(x[r], d, column + (s + r * step) * L); });
    }
    if constexpr (middle > 1) {
      for (int block = 0; block < N; block += step) {
        for (int s = block; s < block + last; ++s) {
          Vec<D> x[middle];
          unroll<middle>([&](auto r)
                             FATHOM_LAMBDA { x[r] = hn::Load(d, column + (s + r * last) * L); });
          small_wht<middle>(d, x);
          unroll<middle>([&](auto r)
                             FATHOM_LAMBDA { hn::Store(x[r], d, column + (s + r * last) * L); });
        }
      }
    }
    for (int p = 0; p < N; p += last) {
      Vec<D> x[last];
      unroll<last>([&](auto r) FATHOM_LAMBDA { x[r] = hn::Load(d, column + (p + r) * L); });
      small_wht<last>(d, x);
      consume(p, x);
    }
  }
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
