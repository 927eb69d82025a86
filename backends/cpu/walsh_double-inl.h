// SPDX-License-Identifier: Apache-2.0
// What the Walsh kernels in double share.
#if defined(FATHOM_CPU_WALSH_DOUBLE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef FATHOM_CPU_WALSH_DOUBLE_INL_H_
#undef FATHOM_CPU_WALSH_DOUBLE_INL_H_
#else
#define FATHOM_CPU_WALSH_DOUBLE_INL_H_
#endif

#include <complex>
#include <span>

#include "backends/cpu/pixels-inl.h"
#include "backends/cpu/wht-inl.h"
#include "engine/tables.hpp"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

/// What the moment is summed in: exact sums as integers, rounded ones as they are.
///
/// With pixels about the middle of their range, |f| <= M = 2^15, Parseval gives SUM T^2 <= (M
/// N^2)^2 along a row, and by Cauchy-Schwarz eight coefficients of it have
///     SUM |T| j^2 <= M N^2 sqrt(8) N^2 <= 2^15 2^18 2^1.5 2^18 < 2^53,
/// exact in double; so are the sums of magnitudes. A whole row's SUM |T| j^2 need not be.
template <class D>
class Moment {
 public:
  HWY_INLINE HWY_ATTR explicit Moment(bool exact) : exact_(exact) {}

  /// Adds the group's SUM |T| j^2.
  HWY_INLINE HWY_ATTR void add(D, Vec<D> group) {
    if (exact_) {
      integer_ = hn::Add(integer_, hn::ConvertTo(d64_, group));
    } else {
      rounded_ = hn::Add(rounded_, group);
    }
  }
  /// Ends the lanes of a strip: adds i^2 times SUM |T|, for each lane its own i^2.
  HWY_INLINE HWY_ATTR void finish(D d, Vec<D> mass_sum, const std::int32_t* squared_i) {
    alignas(64) std::int64_t integer[kLanes<D>];
    alignas(64) double rounded[kLanes<D>], mass[kLanes<D>];
    hn::Store(integer_, d64_, integer);
    hn::Store(rounded_, d, rounded);
    hn::Store(mass_sum, d, mass);
    for (int lane = 0; lane < kLanes<D>; ++lane) {
      exact_sum_ += static_cast<std::uint64_t>(integer[lane]);
      rounded_sum_ += rounded[lane];
      if (exact_) {
        exact_sum_ += static_cast<std::uint64_t>(mass[lane]) * squared_i[lane];
      } else {
        rounded_sum_ += mass[lane] * squared_i[lane];
      }
    }
    integer_ = hn::Zero(d64_);
    rounded_ = hn::Zero(d);
  }
  double sum() const { return exact_ ? static_cast<double>(exact_sum_) : rounded_sum_; }

 private:
  static constexpr hn::Rebind<std::int64_t, D> d64_{};
  bool exact_;
  hn::Vec<hn::Rebind<std::int64_t, D>> integer_ = hn::Zero(hn::Rebind<std::int64_t, D>());
  Vec<D> rounded_ = hn::Zero(D());
  std::uint64_t exact_sum_ = 0;
  double rounded_sum_ = 0;
};

/// The constant that may be taken from every pixel of an untapered window: it changes T(0, 0) only,
/// which has no lever arm. Half of the range keeps all others small.
template <class Pixel>
double middle_of_range(const Tables& tables, bool all_coefficients) {
  if (all_coefficients || tables.spec.taper != Taper::none()) return 0;
  return std::is_same_v<Pixel, std::uint8_t> ? 128 : 32768;
}

/// Magnitudes, or squares, of R coefficients.
template <int R, class D>
HWY_INLINE HWY_ATTR void walsh_masses(const Vec<D> (&t)[R], bool power, Vec<D> (&mass)[R]) {
  if (power) {
    unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = hn::Mul(t[r], t[r]); });
  } else {
    unroll<R>([&](auto r) FATHOM_LAMBDA { mass[r] = hn::Abs(t[r]); });
  }
}

/// The means of rings: rounded once where the sums are whole numbers.
inline void ring_means(const Tables& tables, const double* sums, std::size_t stride,
                       double* values) {
  const RingTables& rings = *tables.rings;
  const double pixels = static_cast<double>(tables.spec.n) * tables.spec.n;
  for (int k = 0; k < rings.count; ++k) {
    const double sum = sums[k * stride];
    values[k] =
        tables.spec.is_exact() ? sum / (rings.coefficients[k] * pixels) : sum * rings.factor[k];
  }
}

/// [row][col] of Plan::spectrum for coefficient (i, j) by position.
inline std::complex<double>& coefficient_at(const WalshTables& constants, int i, int j,
                                            std::span<std::complex<double>> coefficients) {
  const auto n = constants.index.size();
  return coefficients[constants.index[i] * n + constants.index[j]];
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
