// SPDX-License-Identifier: Apache-2.0
// What is measured: the transform, its size, its taper, and what is made of the coefficients.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace fathom {

/// The transforms of the thesis, and the cosine transform. The three Walsh orders hold the same
/// coefficients in different places, so their moments of inertia differ (thesis T4, T5;
/// docs/metrics.md).
enum class Transform {
  fft,             ///< 2-D discrete Fourier transform (eq. 3-10).
  walsh_paley,     ///< Walsh-Hadamard in dyadic order, the thesis' "normal" order.
  walsh_sequency,  ///< Walsh-Hadamard by number of zero crossings.
  walsh_hadamard,  ///< Walsh-Hadamard in natural order, rows of the Sylvester matrix.
  dct,             ///< 2-D discrete cosine transform of type II (Ahmed, Natarajan, Rao 1974).
};

/// Transforms that share their basis functions, and so their kernels.
enum class TransformFamily {
  fourier,  ///< Complex; spectra are centred, and half of the plane mirrors the other half.
  walsh,    ///< Real, of +1 and -1; index 0 comes first.
  cosine,   ///< Real; the window is continued by its mirror images; index 0 comes first.
};

/// Which family a transform belongs to.
constexpr TransformFamily family_of(Transform transform) {
  switch (transform) {
    case Transform::fft:
      return TransformFamily::fourier;
    case Transform::walsh_paley:
    case Transform::walsh_sequency:
    case Transform::walsh_hadamard:
      return TransformFamily::walsh;
    case Transform::dct:
      return TransformFamily::cosine;
  }
  return {};  // no such transform
}

/// Cycles per window that one step of a coefficient's index stands for: 1 for fft, 1/2 for
/// walsh_sequency and dct. Absent where indices have no order of frequency, so neither bands nor
/// rings.
std::optional<double> cycles_per_index(Transform transform);

/// "fft", "walsh-paley", "walsh-sequency", "walsh-hadamard" or "dct".
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
  /// counts. For walsh_sequency and dct index i stands for i/2 cycles a window, so the radii are
  /// twice as long.
  bool contains(Transform transform, int n, double squared_radius) const;
  bool operator==(const Band&) const = default;
};

/// What is made of a window's coefficients.
enum class Measure {
  moment,   ///< One number: the moment of inertia (eqs. 5-1, 5-2).
  rings,    ///< K numbers: the mean mass in rings of spatial frequency (docs/metrics.md, "Rings").
  entropy,  ///< One number: the normalised spectrum's entropy (docs/metrics.md, "Entropy").
};

/// "moment", "rings" or "entropy".
const char* to_string(Measure measure) noexcept;

inline constexpr int kFewestRings = 2;
inline constexpr int kMostRings = 32;

/// A focus metric: a value that compares, and has ONE canonical text that the command line, logs,
/// run files, tests and benchmarks all use:
///
///   TRANSFORM:N[:TAPER][:power][:band=LO-HI][:rings=K]
///   dct:N:entropy[:band=LO-HI]
///   e.g. fft:64:hann, walsh-sequency:64:band=0-0.25, fft:64:hann:power:rings=16
///
/// The taper is always printed for fft, for Walsh only if there is one; dct has none.
struct MetricSpec {
  Transform transform = Transform::fft;
  int n = 64;  ///< Side of the window, px.
  Taper taper = Taper::hann();
  bool power = false;  ///< Mass is the squared magnitude instead of the magnitude.
  std::optional<Band> band = std::nullopt;  ///< Coefficients that count; all when absent.
  Measure measure = Measure::moment;
  int rings = 0;  ///< K of `rings`, 0 of the others.

  /// The thesis' metric for a transform: hann before the FFT, no taper before Walsh.
  static MetricSpec standard(Transform transform, int n);

  /// Reads such a text, in which N may be left out: then n_if_omitted is taken. Throws
  /// Error(bad_argument) saying which part is wrong and what may stand there.
  static MetricSpec parse(std::string_view text, int n_if_omitted = 64);

  /// Whether the text names N itself, so that a caller can tell a choice from a default.
  static bool names_n(std::string_view text);

  /// The canonical text; parse(text()) == *this.
  std::string text() const;

  /// Throws Error(bad_argument) unless N, taper, band and measure are ones that the definition
  /// covers.
  void validate() const;

  /// Numbers that one window gives: K of `rings`, else 1.
  std::size_t outputs() const;

  /// Whether the weighted mean is subtracted from the pixels before the taper: for rings of fft
  /// under a taper, which else would hold the window's brightness (docs/metrics.md, "Rings").
  bool subtracts_mean() const;

  /// The metric of the same transform, N and taper whose spectrum this one is made of.
  MetricSpec plain() const { return {.transform = transform, .n = n, .taper = taper}; }

  /// Whether scores are sums of integers that every backend gives to the last bit: Walsh without a
  /// taper and without power (thesis.md, "The focus quality value").
  bool is_exact() const;

  bool operator==(const MetricSpec&) const = default;
};

}  // namespace fathom
