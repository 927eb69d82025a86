// SPDX-License-Identifier: Apache-2.0
// What a metric makes of a spectrum: the moment of inertia, the mean mass in rings of spatial
// frequency, or the entropy (docs/metrics.md).
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "metric.hpp"

namespace fathom {

/// Which ring a coefficient lies in, and how many lie in each. Ring k holds those with
///   e(k) < r <= e(k + 1),   e(k) = (LO + (HI - LO) k / K) N cycles per window,
/// where LO-HI is the metric's band, 0-0.5 without one, and r the distance from zero frequency:
/// sqrt(u^2 + v^2) for fft, sqrt(i^2 + j^2) / 2 for walsh_sequency and dct.
class Rings {
 public:
  static constexpr int kNone = -1;

  /// spec.rings and spec.band count, whatever the measure; the transform must have an order of
  /// frequency. Not validated: a ring may be empty.
  explicit Rings(const MetricSpec& spec);

  int count() const { return static_cast<int>(coefficients_.size()); }

  /// The ring of the coefficients that lie so many indices from zero frequency (|u| and |v|, or i
  /// and j), whatever their order; kNone outside of all. Up to N/2 each for fft, else N - 1.
  int of(int row, int col) const;

  /// [k] coefficients of the whole plane in ring k, mirrored ones counted too.
  std::span<const std::uint32_t> coefficients() const { return coefficients_; }

  /// Whether no ring is empty.
  bool has_all() const;

 private:
  void count_coefficients(const MetricSpec& spec);

  double cycles_per_index_;
  std::vector<double> squared_edges_;  ///< [k] e(k)^2, K + 1 of them.
  std::vector<std::uint32_t> coefficients_;
};

/// A metric's numbers from coefficients of spec.plain(), as Plan::spectrum gives them: slow, and
/// right for every measure. Allocates nothing after it was made.
class SpectrumMeasure {
 public:
  explicit SpectrumMeasure(const MetricSpec& spec);

  /// coefficients: n n, [row][col]; values: spec.outputs().
  void operator()(std::span<const std::complex<double>> coefficients, std::span<double> values);

 private:
  double moment_of(std::span<const std::complex<double>> coefficients) const;
  void ring_means(std::span<const std::complex<double>> coefficients, std::span<double> values);
  double entropy_of(std::span<const std::complex<double>> coefficients) const;
  std::complex<double> mean_at(int v, int u) const;
  double mean_of(long double sum, std::uint32_t count) const;

  MetricSpec spec_;
  std::vector<std::int8_t> ring_of_;         ///< [row][col]; of rings.
  std::vector<std::uint32_t> counts_;        ///< [k] coefficients; of rings.
  std::vector<double> weights_;              ///< [row][col]; of an entropy.
  std::vector<std::complex<double>> taper_;  ///< Its spectrum, where the mean is subtracted.
  std::vector<long double> sums_;
};

}  // namespace fathom
