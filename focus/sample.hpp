// SPDX-License-Identifier: Apache-2.0
// What one picture gives a search: its score, and what else of it tells whether to believe that.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace fathom {

/// A window is looked at in parts as well: 3 x 3 windows of half its side that overlap by half,
/// [row][column].
inline constexpr int kPartsAcross = 3, kParts = kPartsAcross * kPartsAcross;

/// What a search by spectra looks at: fft:N:hann:power:rings=K, of a window with the same middle as
/// the one that is scored, or as near to it as the picture allows.
struct RingPowers {
  int side = 0;               ///< N, px.
  std::vector<float> powers;  ///< [k], (grey values)^2.

  bool operator==(const RingPowers&) const = default;
};

/// Of the window that was scored, but for `light`; grey values are the camera's. Zero stands for "not known".
struct PictureFacts {
  double brightness = 0;  ///< Mean grey value,
  double light = 0;       ///< and that of the whole picture, which blur does not change.
  double deviation = 0;   ///< Standard deviation of the grey values.
  /// Standard deviation of the pixels' noise, from what neither a slope nor an edge along an axis
  /// touches (Immerkaer 1996). Texture as fine as pixels adds to it.
  double noise = 0;
  double saturated = 0;  ///< Part of the pixels at the camera's maximum, 0..1.
  std::array<double, kParts>
      parts{};  ///< Scores of the parts, by the same metric at half the side,
  std::array<double, kParts> part_brightness{};  ///< and their mean grey values.
  std::vector<RingPowers> rings = {};            ///< By side, increasing; none where nobody asked.
  /// Sums of the grey values of equal squares round it, row by row; none where nobody asked.
  std::vector<std::uint32_t> cells = {};

  bool operator==(const PictureFacts&) const = default;
};

/// Of a picture that was taken while the lens went on; lengths in its unit.
struct OnTheWay {
  double sigma = 0;  ///< Standard uncertainty of the position, which is the middle of the way,
  double smear = 0;  ///< and how far the lens travelled within the exposure.

  bool operator==(const OnTheWay&) const = default;
};

/// What one frame said: its score, and what is known of its picture and its lens.
struct Sample {
  double score = 0;
  PictureFacts picture;
  std::optional<OnTheWay> on_the_way;  ///< Absent for a lens at rest.

  /// A score alone is a sample of which nothing else is known.
  Sample(double its_score, const PictureFacts& its_picture = {},
         const std::optional<OnTheWay>& its_way = {})
      : score(its_score), picture(its_picture), on_the_way(its_way) {}
};

}  // namespace fathom
