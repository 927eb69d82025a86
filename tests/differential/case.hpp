// SPDX-License-Identifier: Apache-2.0
// What one round asks of every device: a metric, a picture, its layout in memory and windows.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/metric.hpp"
#include "engine/window.hpp"
#include "tests/support/frames.hpp"

namespace fathom::differential {

struct Case {
  MetricSpec spec;
  std::string picture = "random@64";  ///< What draw() takes.
  int bits = 8;
  int width = 0, height = 0;  ///< Of the picture as it is drawn.
  std::uint64_t seed = 0;     ///< Of the picture.
  struct Crop {
    int x, y, width, height;
    bool operator==(const Crop&) const = default;
  } crop = {};                  ///< The part of it that is the frame.
  int gap = 0;                  ///< Bytes between rows of the frame.
  std::vector<Window> windows;  ///< Of the frame.

  /// "fft:8:hann/wave+spots@8/8/40x30/seed=7/crop=0,0,40,30/gap=3/windows=0,0;5,9"
  std::string text() const;
  /// Reads that. Throws std::invalid_argument for anything else.
  static Case parse(const std::string& text);

  /// The frame's pixels.
  test::Pixels pixels() const;
  bool operator==(const Case&) const = default;
};

/// What random cases are drawn from.
struct Choice {
  std::vector<std::string> transforms = {"fft", "walsh-paley", "walsh-sequency", "walsh-hadamard",
                                         "dct"};
  std::vector<int> sides = {8, 16, 32, 64, 128, 256, 512};  ///< The first likelier than the last.
  std::vector<std::string> pictures;                        ///< Of picture_kinds(); empty: all.
  std::vector<int> bits = {8, 16};
  std::size_t windows = 300;  ///< At most.
};

/// The case of a seed.
Case random_case(std::uint64_t seed, const Choice& choice);

}  // namespace fathom::differential
