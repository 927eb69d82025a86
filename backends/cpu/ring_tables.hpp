// SPDX-License-Identifier: Apache-2.0
// Where the rings of a metric lie among the coefficients, in the order in which the kernels read
// them (docs/metrics.md, "Rings").
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "engine/measure.hpp"
#include "engine/metric.hpp"

namespace fathom::cpu {

/// Which ring each coefficient lies in, and how a ring's sum becomes its mean.
struct RingTables {
  explicit RingTables(const MetricSpec& spec);

  int count = 0;  ///< K.
  /// [k] coefficients of the whole plane. Times N^2 what exact sums are divided by.
  std::vector<double> coefficients;
  /// [k] from the sum over what the kernels hold to the mean: fft sums half of the plane.
  std::vector<double> factor;
  /// [position of u or j][position of v or i] the ring, K outside of all.
  std::vector<std::uint8_t> slot;
};

/// Narrow rings as the widest registers meet them in a strip of a Fourier transform, below: sums
/// have a lane per ring, and rows v move there. A layer moves at most one row of a column to each.
template <class T>
class RingLayers {
 public:
  static constexpr int kLanes = 64 / sizeof(T);
  using Index = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;

  explicit RingLayers(const MetricSpec& spec);

  /// Whether a layer moves enough to be worth it.
  static bool suit(const MetricSpec& spec);

  /// Of one column, [ring]: the lane of a row, and how often it counts, 0 for no row.
  struct alignas(64) Move {
    Index from[kLanes];
    T share[kLanes];
  };
  /// Columns first <= |u| < end, an even number of them, so that `end` may be N/2 + 2.
  struct Layer {
    int first = 0, end = 0;
    std::size_t moves = 0;  ///< Where that of column `first` is.
  };

  /// Those of rings k, k + 1, .., k a multiple of kLanes.
  std::span<const Layer> layers(int strip, int k) const {
    const std::size_t* const part = &parts_[strip * registers_ + k / kLanes];
    return {layers_.data() + part[0], layers_.data() + part[1]};
  }
  const Move* moves(const Layer& layer) const { return moves_.data() + layer.moves; }

 private:
  void add_layers(const Rings& rings, int strip, int k);

  int half_, registers_;
  std::vector<Move> moves_;
  std::vector<Layer> layers_;
  std::vector<std::size_t> parts_;  ///< [strip][k / kLanes] the first layer; and the end.
};

/// The rings as strips of a Fourier transform meet them: a strip is as many rows v as a register
/// has lanes, from v = 1 on, and columns u and -u are added up.
template <class T>
class StripRings {
 public:
  explicit StripRings(const MetricSpec& spec);

  /// Columns |u| of a strip in which a ring has coefficients: first <= |u| < end. Those of a strip
  /// have an even length, so that `end` may be N/2 + 2.
  struct Run {
    std::int16_t first = 0, end = 0;
  };

  /// [k] of a strip.
  template <int kLanes>
  const Run* runs(int strip) const {
    return runs_[index_of(kLanes)].data() + strip * count_;
  }
  /// [k] of the row v = 0.
  const Run* zero_row() const { return zero_row_.data(); }

  /// The ring of the coefficients |u| = 0 .. N/2 + 1, in the rows v = 1 .. N/2. Aligned for any
  /// vector.
  const T* row(int u) const { return lines_[u * lines_per_row_].lane; }

  /// None where runs are quicker.
  const RingLayers<T>* layers() const { return layers_ ? &*layers_ : nullptr; }

 private:
  struct alignas(64) Line {
    T lane[64 / sizeof(T)];
  };
  static constexpr int index_of(int lanes) { return lanes <= 2 ? 0 : 1 + index_of(lanes / 2); }

  static void extend(Run& run, int u);
  std::vector<Run> runs(int lanes) const;

  int count_, half_, lines_per_row_;
  std::vector<Line> lines_;
  std::vector<Run> runs_[4];  ///< For 2, 4, 8 and 16 lanes: [strip][k].
  std::vector<Run> zero_row_;
  std::optional<RingLayers<T>> layers_;
};

/// The rings as rows i of Walsh coefficients meet them in order of sequency: of row i, ring k holds
/// columns j from that of edge k up to, not including, that of edge k + 1.
struct SequencyRings {
  explicit SequencyRings(const MetricSpec& spec);

  int edges = 0;                    ///< K + 1.
  std::vector<std::int32_t> start;  ///< [edge][position of i].
};

/// Whether ring means in float may be off by more than the tolerance. Formulas, and where each
/// constant comes from: docs/metrics.md, "Rings in float".
class RingDoubt {
 public:
  explicit RingDoubt(const MetricSpec& spec);

  /// values: the means; energy: SUM |2 N^2 F|^2 over the plane, the mean subtracted. True also for
  /// what is no number.
  bool about(std::span<const double> values, double energy) const;

 private:
  // noise: squared, of a coefficient.
  bool allows_magnitude(double value, double noise) const;
  bool allows_power(double value, double noise, double squared_spread) const;

  bool is_power_;
  double per_energy_;                   ///< To the squared noise of a coefficient.
  double quantum_;                      ///< What rounding pixels to grey levels leaves in a ring.
  std::vector<double> squared_spread_;  ///< [k] of the noise in a ring, at least 1.
};

}  // namespace fathom::cpu
