// SPDX-License-Identifier: Apache-2.0
// What the Fourier kernels share: from coefficients to masses, and to where the caller wants them.
#if defined(FATHOM_CPU_FOURIER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FOURIER_INL_H_
#undef FATHOM_CPU_FOURIER_INL_H_
#else
#define FATHOM_CPU_FOURIER_INL_H_
#endif

#include <complex>
#include <span>

#include "backends/cpu/fft-inl.h"
#include "backends/cpu/pixels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

template <class T>
const FourierTables<T>& fourier_tables(const Tables& tables) {
  if constexpr (std::is_same_v<T, float>) {
    return *tables.fourier_float;
  } else {
    return *tables.fourier_double;
  }
}

/// To a relative error of 1e-7 in float.
template <class V>
HWY_INLINE HWY_ATTR V square_root(V p) {
#if HWY_TARGET <= HWY_AVX3 && HWY_ARCH_X86
  // The estimate 1/sqrt(p) to 14 bits and one Newton step, on units that are free meanwhile; the
  // square root itself takes ten cycles a register. sqrt(0) is 0 * a large number.
  if constexpr (std::is_same_v<hn::TFromV<V>, float>) {
    const hn::DFromV<V> d;
    const auto y = hn::ApproximateReciprocalSqrt(hn::Max(p, hn::Set(d, 1e-30F)));
    const auto root = hn::Mul(p, y), half = hn::Mul(y, hn::Set(d, 0.5F));
    const auto error = hn::NegMulAdd(root, half, hn::Set(d, 0.5F));
    return hn::MulAdd(root, error, root);
  }
#endif
  return hn::Sqrt(p);
}

/// |F| or |F|^2 of R coefficients, zero outside the band.
template <int R, class D>
HWY_INLINE HWY_ATTR void masses(D, const Complex<D> (&coefficients)[R], bool power,
                                Vec<D> (&mass)[R]) {
  unroll<R>([&](auto r) FATHOM_LAMBDA {
    const auto& z = coefficients[r];
    mass[r] = hn::MulAdd(z.re, z.re, hn::Mul(z.im, z.im));
  });
  if (power) return;
  unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = square_root(mass[r]); });
}

/// Adds the lanes to as many doubles.
template <class D>
HWY_INLINE HWY_ATTR void add_lanes(D d, Vec<D> v, double* HWY_RESTRICT sums) {
  if constexpr (std::is_same_v<hn::TFromD<D>, float>) {
    const hn::Half<D> half;
    const hn::Rebind<double, decltype(half)> wide;
    double* const upper = sums + kLanes<D> / 2;
    hn::Store(hn::Add(hn::Load(wide, sums), hn::PromoteTo(wide, hn::LowerHalf(half, v))), wide,
              sums);
    hn::Store(hn::Add(hn::Load(wide, upper), hn::PromoteTo(wide, hn::UpperHalf(half, v))), wide,
              upper);
  } else {
    hn::Store(hn::Add(hn::Load(d, sums), v), d, sums);
  }
}

/// phi = 1/N^4 1/2 SUM |F| r^2, where F is what a kernel has, times 1/(2 N^2). With `power` the
/// factor of F counts twice. All are powers of two and exact.
inline double fourier_scale(const MetricSpec& spec) {
  const double n = spec.n;
  const double coefficient = 1 / (2 * n * n);
  return (spec.power ? coefficient * coefficient : coefficient) / (n * n * n * n);
}

/// Puts F(u, v) and, since pixels are real, its mirror image where Plan::spectrum wants them.
inline void place_coefficient(std::complex<double> f, int u, int v, int n,
                              std::span<std::complex<double>> coefficients) {
  const int half = n / 2, mask = n - 1;
  const double scale = 1.0 / (2.0 * n * n);
  const auto at = [&](int row, int col) -> auto& {
    return coefficients[static_cast<std::size_t>((row + half) & mask) * n + ((col + half) & mask)];
  };
  at(-v, -u) = std::conj(f) * scale;
  at(v, u) = f * scale;
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
