// SPDX-License-Identifier: Apache-2.0
// The constants of one metric in the order in which the kernels read them: engine/tables.hpp,
// permuted and narrowed, so that a kernel reads them from the first to the last.
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <vector>

#include "backends/cpu/ring_tables.hpp"
#include "engine/metric.hpp"

namespace fathom::cpu {

/// In-place transforms leave coefficient k of N at a position of their own: nobody puts them in
/// order, because a sum does not mind. Tables "by position" follow that order.
///
/// The radices of an in-place Fourier transform of N points, first stage first.
struct Radices {
  int count = 0;
  int radix[3] = {};
};

/// As few stages as can be, for each is one trip through the cache, of radices 8 and 4. There is no
/// radix 2, hence two fours for 16 and for 128.
constexpr Radices radices(int n) {
  switch (n) {
    case 8:
      return {1, {8}};
    case 16:
      return {2, {4, 4}};
    case 32:
      return {2, {8, 4}};
    case 64:
      return {2, {8, 8}};
    case 128:
      return {3, {8, 4, 4}};
    case 256:
      return {3, {8, 8, 4}};
    default:
      return {3, {8, 8, 8}};
  }
}

/// The frequency k = 0 .. n-1 that a transform by decimation in frequency leaves at each position.
std::vector<int> frequency_by_position(int n);

/// Constants of the Fourier kernels in the arithmetic T.
template <class T>
struct FourierTables {
  explicit FourierTables(const MetricSpec& spec);

  std::vector<T> taper;        ///< [x] w(x).
  std::vector<T> mean_weight;  ///< [x] w(x) / SUM w.
  /// [k = 0 .. 7] of the samples that give a row's mean; their sum is 1.
  std::vector<T> sample_weight;
  std::vector<T> twiddle;  ///< Per stage but the last, [s][q = 1 .. R-1]: re, im of w_M^(qs).
  std::vector<T> flat_re;  ///< [position] N W(k): the transform of a constant 1 under the
  std::vector<T> flat_im;  ///< taper.
  std::vector<std::uint8_t> is_touched;  ///< [position] whether flat is not zero there.
  int touched_until = 0;            ///< The highest frequency up to N/2 where flat is not zero.
  std::vector<T> arm;               ///< [position] squared lever arm.
  std::vector<T> arm_by_frequency;  ///< [frequency 0 .. N/2] the same.
  /// [frequency v = 0 .. N/2] how often row v stands in half of the plane: 1, or 1/2 for the two
  /// rows that are their own mirror images.
  std::vector<T> share;
  std::vector<int> frequency;  ///< [position].
  std::vector<int> position;   ///< [frequency].
  // For Doubt; docs/metrics.md, "When float is not enough".
  std::vector<T> bright_re;  ///< [frequency v = 0 .. N/2] W(v)/W(0): how much of the window's
  std::vector<T> bright_im;  ///< brightness, which stands in row 0, row v has.
  T flat_energy = 0;         ///< SUM |N W(k)|^2, the energy of a row of ones.
  /// 1 inside the band, 0 outside; empty without a band. [position of u][v = 0 .. N/2].
  std::vector<T> mask;
};

/// Whether a score in float may be off by more than the tolerance; then double computes it again.
///
/// Rounding leaves noise of some 2^-24 of the window's contrast, spread evenly over the spectrum,
/// where steep lever arms meet it. A picture with a spectrum of its own out there (texture, sensor
/// noise, the rounding of its pixels) drowns it. One that is very smooth, or varies in one
/// direction only, or hardly at all beside its brightness, does not. So a score is compared with
/// that of the noise. Formulas, and where each constant comes from: docs/metrics.md, "When float is
/// not enough".
class Doubt {
 public:
  explicit Doubt(const MetricSpec& spec);

  /// energy: SUM |2 N^2 F|^2 over the plane, without what brightness alone would give; bright: the
  /// mean of the row v = 0, 2 N W(0) times a grey level. True also for scores that are no number.
  bool about(double score, double energy, double bright) const {
    const double squared_contrast = energy * per_energy_ + bright * bright * per_bright_;
    const double squared_score = is_power_ ? score : score * score;
    return squared_contrast != 0 && !(squared_contrast * limit_ <= squared_score);
  }

 private:
  bool is_power_;
  double per_energy_, per_bright_;  ///< To squared grey levels, summed over the window.
  double limit_;                    ///< Least squared score (`power`: score) per squared contrast.
};

/// The index, in the metric's order, of the Walsh coefficient at each position.
std::vector<int> walsh_index_by_position(const MetricSpec& spec);

/// Constants of the Walsh kernels. Positions of a Walsh transform are those of Hadamard order.
struct WalshTables {
  explicit WalshTables(const MetricSpec& spec);

  std::vector<double> taper;      ///< [x] w(x).
  std::vector<std::int32_t> arm;  ///< [position] squared lever arm.
  std::vector<int> index;         ///< [position] the coefficient's index in the metric's order.
  /// -1 (all bits) inside the band, 0 outside; empty without a band. [position j][position i].
  std::vector<std::int32_t> mask;
};

/// Constants of the cosine kernels, which hold N^2 C.
struct CosineTables {
  explicit CosineTables(const MetricSpec& spec);

  FourierTables<double> fourier;  ///< Of the same N, without taper.
  /// [k] cos and sin of pi k/(2 N) over the root of 2: a coefficient's own is halved, because
  /// kernels have twice the Fourier transform.
  std::vector<double> cosine, sine;
  /// [j][i] what a coefficient's mass counts: squared lever arm, or 1 of an entropy; 0 outside the
  /// band.
  std::vector<double> weights;
  double terms = 0;  ///< Of an entropy: coefficients that have one.
};

/// All that the kernels of one metric read besides pixels.
struct Tables {
  explicit Tables(const MetricSpec& metric);

  MetricSpec spec;
  // Of these, what the metric's transform and measure need is filled.
  std::unique_ptr<const FourierTables<float>> fourier_float;
  std::unique_ptr<const FourierTables<double>> fourier_double;
  std::unique_ptr<const Doubt> doubt;
  std::unique_ptr<const WalshTables> walsh;
  std::unique_ptr<const CosineTables> cosine;
  std::unique_ptr<const RingTables> rings;
  std::unique_ptr<const StripRings<float>> strip_rings_float;
  std::unique_ptr<const StripRings<double>> strip_rings_double;
  std::unique_ptr<const RingDoubt> ring_doubt;
  std::unique_ptr<const SequencyRings> sequency_rings;

 private:
  void fill_fourier();
  void fill_walsh();
};

}  // namespace fathom::cpu
