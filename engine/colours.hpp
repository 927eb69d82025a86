// SPDX-License-Identifier: Apache-2.0
// The colours of a picture, for those who show it: what is measured is its grey frame.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

namespace fathom {

/// Red, green and blue of every pixel, row by row: 3 * width * height samples of 8 or of 16 bits,
/// as its grey frame has them. Both are empty where the picture is grey.
struct Colours {
  std::vector<std::uint8_t> bits8;
  std::vector<std::uint16_t> bits16;

  bool empty() const { return bits8.empty() && bits16.empty(); }

  /// Those of one kind of sample: std::uint8_t or std::uint16_t.
  template <class Sample>
  std::vector<Sample>& of() {
    if constexpr (std::is_same_v<Sample, std::uint8_t>) {
      return bits8;
    } else {
      return bits16;
    }
  }
  template <class Sample>
  const std::vector<Sample>& of() const {
    return const_cast<Colours*>(this)->of<Sample>();
  }
};

}  // namespace fathom
