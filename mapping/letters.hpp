// SPDX-License-Identifier: Apache-2.0
// Small letters in pictures, for the numbers beside a scale.
#pragma once

#include <cstdint>
#include <string_view>

namespace fathom::mapping {

inline constexpr int kLetterHeight = 7;
inline constexpr int kLetterPitch = 6;  ///< From one letter to the next.

/// A picture of one channel that is drawn into; what lies beyond its edges is left out.
struct Canvas {
  std::uint8_t* values;
  int width_px, height_px;

  void fill(int left, int top, int width, int height, std::uint8_t value) const;
  /// Digits, lower-case letters and . - + / in dots of zoom x zoom px; others are blanks.
  void write(int left, int top, std::string_view text, int zoom, std::uint8_t value) const;
};

}  // namespace fathom::mapping
