// SPDX-License-Identifier: Apache-2.0
// What is measured: the transform, its size, its taper and the options of the moment of inertia.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace fathom {

/// The transforms of the thesis. The three Walsh orders hold the same coefficients in different
/// places, so their moments of inertia differ (thesis T4, T5; docs/metrics.md).
enum class Transform {
  fft,             ///< 2-D discrete Fourier transform (eq. 3-10).
  walsh_paley,     ///< Walsh-Hadamard in dyadic order, the thesis' "normal" order.
  walsh_sequency,  ///< Walsh-Hadamard by number of zero crossings.
  walsh_hadamard,  ///< Walsh-Hadamard in natural order, rows of the Sylvester matrix.
};

constexpr bool is_walsh(Transform transform) { return transform != Transform::fft; }

/// "fft", "walsh-paley", "walsh-sequency" or "walsh-hadamard".
const char* to_string(Transform transform) noexcept;

/// Weights on the data before the transform (thesis T3): a raised cosine over the outer fraction of
/// each axis, 1 between. 0 is no taper ("none"), 1 is Tukey-Hanning ("hann"), between is "tukey=A".
struct Taper {
  double cosine_fraction = 0;

  static constexpr Taper none() { return {0}; }
  static constexpr Taper hann() { return {1}; }
  bool operator==(const Taper&) const = default;
};

/// "none", "hann" or "tukey=A".
std::string to_string(Taper taper);

/// Spatial frequencies that count, in cycles per pixel: low < r <= high.
struct Band {
  double low = 0;
  double high = 0;

  /// Whether the coefficient at squared radius u^2 + v^2 (or i^2 + j^2) of an N x N transform
  /// counts. For walsh_sequency index i stands for i/2 cycles a window, so the radii are twice as
  /// long.
  bool contains(Transform transform, int n, double squared_radius) const;
  bool operator==(const Band&) const = default;
};

/// A focus metric: a value that compares, and has ONE canonical text that the command line, logs,
/// records, tests and benchmarks all use:
///
///   TRANSFORM:N[:TAPER][:power][:band=LO-HI]     e.g. fft:64:hann, walsh-sequency:64:band=0-0.25
///
/// The taper is always printed for fft, and for Walsh only if there is one.
struct MetricSpec {
  Transform transform = Transform::fft;
  int n = 64;  ///< Side of the window, px.
  Taper taper = Taper::hann();
  bool power = false;        ///< Mass is the squared magnitude instead of the magnitude.
  std::optional<Band> band;  ///< Coefficients that count; all when absent.

  /// The thesis' metric for a transform: hann before the FFT, no taper before Walsh.
  static MetricSpec standard(Transform transform, int n);

  /// Reads TRANSFORM[:N][:TAPER][:power][:band=LO-HI]; n_if_omitted is taken where N is left out.
  /// Throws Error(bad_argument) saying which part is wrong and what may stand there.
  static MetricSpec parse(std::string_view text, int n_if_omitted = 64);

  /// Whether the text names N itself, so that a caller can tell a choice from a default.
  static bool names_n(std::string_view text);

  /// The canonical text; parse(text()) == *this.
  std::string text() const;

  /// Throws Error(bad_argument) unless N, taper and band are ones that the definition covers.
  void validate() const;

  /// Whether scores are sums of integers that every backend gives to the last bit: Walsh without a
  /// taper and without power (thesis.md, "The focus quality value").
  bool is_exact() const { return is_walsh(transform) && taper == Taper::none() && !power; }

  bool operator==(const MetricSpec&) const = default;
};

}  // namespace fathom
