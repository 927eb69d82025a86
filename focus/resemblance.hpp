// SPDX-License-Identifier: Apache-2.0
// Whether another picture shows what the picture of a peak shows, as it does of an object. Noise
// makes peaks too, but is never the same twice.
#pragma once

#include <optional>
#include <vector>

namespace fathom {

struct Focus;

/// A rectangle of grey values, row by row.
struct Patch {
  int width = 0;
  int height = 0;
  std::vector<float> greys;  ///< width * height, or empty.

  bool operator==(const Patch&) const = default;
};

/// How alike two pictures are, beyond chance.
struct Resemblance {
  /// How far beyond chance two pictures agree, at the shift where they agree most: some logarithm
  /// of how often noise would, natural. Noise reaches 5 once in a hundred pairs.
  double evidence = 0;
  /// How evenly the detail of the peak's picture is spread, 0..1: some 0.9 of noise, 0.1 of a wire.
  double evenness = 1;

  bool operator==(const Resemblance&) const = default;
};

/// What this much evidence supports is in both pictures.
inline constexpr double kEvident = 7;
/// What is spread more evenly than this may be noise.
inline constexpr double kEven = 0.5;

/// Energy of what is finer than some pixels, of every pixel: `patch.greys` in layout.
std::vector<float> detail_energy(const Patch& patch);

/// Compares a patch with another picture's, where it lies (x, y) from the upper left corner; the
/// picture may have shifted by up to `reach_px` in any direction, and what of it is outside of
/// `other` is left out. Nothing where a patch is flat, or the pixels are the very same, which only
/// a copy is.
std::optional<Resemblance> compare(const Patch& patch, const Patch& other, int x, int y,
                                   int reach_px);

/// Takes it into account: what is even as noise, and nowhere else, is no focus (Why::unshared); of
/// what is nowhere else, though uneven, half is believed. Nothing happens to what is no
/// focus, or one that spectra alone tell of: there noise is expected.
void doubt_for_resemblance(Focus& focus, const std::optional<Resemblance>& resemblance);

}  // namespace fathom
