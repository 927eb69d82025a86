// SPDX-License-Identifier: Apache-2.0
// What the Fourier kernels share: from coefficients to masses, and to where the caller wants them.
#if defined(FATHOM_CPU_FOURIER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_FOURIER_INL_H_
#undef FATHOM_CPU_FOURIER_INL_H_
#else
#define FATHOM_CPU_FOURIER_INL_H_
#endif

#include <algorithm>
#include <complex>
#include <span>

#include "backends/cpu/fft-inl.h"
#include "backends/cpu/pixels-inl.h"
#include "engine/tables.hpp"

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

template <class T>
const StripRings<T>& strip_rings(const Tables& tables) {
  if constexpr (std::is_same_v<T, float>) {
    return *tables.strip_rings_float;
  } else {
    return *tables.strip_rings_double;
  }
}

/// The kernel in double, in a file of its own so that compilers take them at the same time.
Kernel fourier_kernel_in_double(int n, Depth depth, Measure measure);

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

/// |F|^2.
template <int R, class D>
HWY_INLINE HWY_ATTR void norms(D, const Complex<D> (&z)[R], Vec<D> (&norm)[R]) {
  unroll<R>([&](auto r) FATHOM_LAMBDA {
    norm[r] = hn::MulAdd(z[r].re, z[r].re, hn::Mul(z[r].im, z[r].im));
  });
}

/// In pairs: a running sum of many equal terms would be rounded the same way again and again.
template <int R, class D>
HWY_INLINE HWY_ATTR Vec<D> sum_of(D d, const Vec<D> (&terms)[R]) {
  if constexpr (R == 1) {
    return terms[0];
  } else {
    Vec<D> half[R / 2];
    unroll<R / 2>([&](auto r) FATHOM_LAMBDA { half[r] = hn::Add(terms[2 * r], terms[2 * r + 1]); });
    return sum_of(d, half);
  }
}

/// Sums over the coefficients of a row (or column), per lane.
template <class D>
struct RowSums {
  Vec<D> mass;    ///< SUM m, m = |F| or |F|^2.
  Vec<D> moment;  ///< SUM m u^2.
  Vec<D> energy =
      hn::Zero(D());  ///< SUM |F|^2 of what was transformed, without the row's constant.
  Complex<D> mean;    ///< That constant.
};

template <class D>
HWY_INLINE HWY_ATTR RowSums<D> empty_sums(D d) {
  const auto zero = hn::Zero(d);
  return {zero, zero, zero, {zero, zero}};
}

/// Adds R coefficients at position p, as tapered_fft gives them. get_mask(position) is 1 inside the
/// band and 0 outside.
template <int R, class D, class GetMask>
HWY_INLINE HWY_ATTR void add_coefficients(D d, const FourierTables<hn::TFromD<D>>& tables,
                                          bool power, int p, Complex<D> (&x)[R], Complex<D> mean,
                                          const GetMask& get_mask, RowSums<D>& sums) {
  Vec<D> mass[R];
  norms(d, x, mass);
  if constexpr (std::is_same_v<hn::TFromD<D>, float>) {  // double is never in doubt
    sums.energy = hn::Add(sums.energy, sum_of(d, mass));
    sums.mean = mean;
  }
  if (is_touched<R>(tables, p)) {
    add_constant(d, tables, p, mean, x);
    norms(d, x, mass);
  }
  if (!power) unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = square_root(mass[r]); });
  if (!tables.mask.empty()) {
    for (int r = 0; r < R; ++r) mass[r] = hn::Mul(mass[r], get_mask(p + r));
  }
  const hn::TFromD<D>* HWY_RESTRICT arm = tables.arm.data() + p;
  auto moment = hn::Mul(mass[0], hn::Set(d, arm[0]));
  unroll<R - 1>([&](auto r) FATHOM_LAMBDA {
    moment = hn::MulAdd(mass[r + 1], hn::Set(d, arm[r + 1]), moment);
  });
  sums.mass = hn::Add(sums.mass, sum_of(d, mass));
  sums.moment = hn::Add(sums.moment, moment);
}

/// What a row v (or column u) adds to the moment, and what it adds to the energy that Doubt asks
/// for, the other half of the plane left out. bright: the constant of the row v = 0. get(table)
/// gives a table's entries for the rows in the lanes.
template <class D>
struct PlanePart {
  Vec<D> moment, energy;
};

template <class D, class Get>
HWY_INLINE HWY_ATTR PlanePart<D> part_of_plane(D d, const FourierTables<hn::TFromD<D>>& tables,
                                               const RowSums<D>& sums, Vec<D> bright,
                                               const Get& get) {
  const auto share = get(tables.share);
  const auto squared = get(tables.arm_by_frequency);
  const auto moment = hn::Mul(hn::MulAdd(sums.mass, squared, sums.moment), share);
  if constexpr (std::is_same_v<hn::TFromD<D>, double>) {
    return {moment, hn::Zero(d)};
  } else {
    const auto re = hn::NegMulAdd(bright, get(tables.bright_re), sums.mean.re);
    const auto im = hn::NegMulAdd(bright, get(tables.bright_im), sums.mean.im);
    const auto mean_norm = hn::MulAdd(re, re, hn::Mul(im, im));
    const auto energy = hn::MulAdd(mean_norm, hn::Set(d, tables.flat_energy), sums.energy);
    return {moment, hn::Mul(energy, share)};
  }
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

/// Stores the masses of R coefficients at position p, as tapered_fft gives them, [position][lane];
/// adds SUM |F|^2 to the energy. mean: the constant that is added, the window's own subtracted.
template <int R, class D>
HWY_INLINE HWY_ATTR void store_masses(D d, const FourierTables<hn::TFromD<D>>& tables, bool power,
                                      int p, Complex<D> (&x)[R], Complex<D> mean,
                                      hn::TFromD<D>* HWY_RESTRICT masses, Vec<D>& energy) {
  if (is_touched<R>(tables, p)) add_constant(d, tables, p, mean, x);
  Vec<D> mass[R];
  norms(d, x, mass);
  if constexpr (std::is_same_v<hn::TFromD<D>, float>) {  // double is never in doubt
    energy = hn::Add(energy, sum_of(d, mass));
  }
  if (!power) unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = square_root(mass[r]); });
  unroll<R>([&](auto r) FATHOM_LAMBDA { hn::Store(mass[r], d, masses + (p + r) * kLanes<D>); });
}

/// Measures the windows of a block again that float is not to be trusted with. What is_doubtful(w)
/// reads may lie in the scratch memory, as it does: it is asked before the kernel in double runs.
template <class IsDoubtful>
HWY_INLINE void measure_doubtful(const Tables& tables, const Frame& frame,
                                 std::span<const Window> windows, std::span<double> values,
                                 const IsDoubtful& is_doubtful, std::byte* scratch) {
  const std::size_t outputs = values.size() / windows.size();
  Window again[kBlock];
  double result[kBlock * kMostRings];
  std::size_t place[kBlock], count = 0;
  for (std::size_t w = 0; w < windows.size(); ++w) {
    if (!is_doubtful(w)) continue;
    again[count] = windows[w];
    place[count++] = w;
  }
  if (count == 0) return;
  const MetricSpec& spec = tables.spec;
  fourier_kernel_in_double(spec.n, Depth::bits8, spec.measure)
      .score(tables, frame, {again, count}, {result, count * outputs}, scratch);
  for (std::size_t i = 0; i < count; ++i) {
    std::copy_n(result + i * outputs, outputs, &values[place[i] * outputs]);
  }
}

/// The same of moments: Doubt decides.
HWY_INLINE void measure_doubtful_moments(const Tables& tables, const Frame& frame,
                                         std::span<const Window> windows, std::span<double> scores,
                                         const double* energies, const float* bright,
                                         std::byte* scratch) {
  measure_doubtful(
      tables, frame, windows, scores,
      [&](std::size_t w) { return tables.doubt->about(scores[w], energies[w], bright[w]); },
      scratch);
}

/// The same of rings: RingDoubt decides.
HWY_INLINE void measure_doubtful_rings(const Tables& tables, const Frame& frame,
                                       std::span<const Window> windows, std::span<double> values,
                                       const double* energies, std::byte* scratch) {
  const std::size_t count = tables.rings->factor.size();
  measure_doubtful(
      tables, frame, windows, values,
      [&](std::size_t w) {
        return tables.ring_doubt->about(values.subspan(w * count, count), energies[w]);
      },
      scratch);
}

/// Puts F(u, v) and, since pixels are real, its mirror image where Plan::spectrum wants them.
inline void place_coefficient(std::complex<double> f, int u, int v, int n,
                              std::span<std::complex<double>> coefficients) {
  const int half = n / 2, mask = n - 1;
  const double scale = tables::coefficient_scale(Transform::fft, n);
  const auto at = [&](int row, int col) -> auto& {
    return coefficients[static_cast<std::size_t>((row + half) & mask) * n + ((col + half) & mask)];
  };
  at(-v, -u) = std::conj(f) * scale;
  at(v, u) = f * scale;
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
