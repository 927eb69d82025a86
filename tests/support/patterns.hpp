// SPDX-License-Identifier: Apache-2.0
// Deterministic pictures to test with. Integers only, so that every machine draws the same ones,
// and nothing of the library, so that the generator of the golden values can share it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::test {

/// Sebastiano Vigna's SplitMix64: tiny, and good enough to fill pictures.
class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
  }

  /// 0 .. limit - 1; the bias is far below what a picture shows.
  std::uint32_t below(std::uint32_t limit) {
    return static_cast<std::uint32_t>(((next() >> 32) * limit) >> 32);
  }

 private:
  std::uint64_t state_;
};

/// Grey values row by row, 8-bit ones too: what a picture holds, before anybody stores it.
struct Pixels {
  int width = 0;
  int height = 0;
  int bits = 8;
  std::vector<std::uint16_t> values;

  std::uint16_t& at(int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; }
  std::uint16_t at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
  std::uint32_t largest() const { return (1U << bits) - 1; }
};

/// What make_pixels draws:
///   zero, flat, full          constant: 0, about 0.7 of the range, all of it
///   nearly-flat                     flat with every pixel at random one grey level off, or not
///   impulse                   one pixel of full height on black
///   ramp, checkerboard        smooth; the highest frequency there is
///   random, binary            white noise; 0 or full at random
///   natural                   equal power in every octave, as photographs have (1/f amplitudes)
inline const std::vector<std::string>& contents() {
  static const std::vector<std::string> names = {"zero",    "flat",   "full",         "nearly-flat",
                                                 "impulse", "ramp",   "checkerboard", "random",
                                                 "binary",  "natural"};
  return names;
}

namespace detail {

/// Adds lattice noise of one octave, bilinear between lattice points `cell` pixels apart, 0 ..
/// 4095.
inline void add_octave(std::vector<std::uint32_t>& sum, int width, int height, int cell,
                       SplitMix64& noise) {
  const int columns = width / cell + 2;
  std::vector<std::uint32_t> lattice(static_cast<std::size_t>(columns) * (height / cell + 2));
  for (auto& value : lattice) value = noise.below(4096);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint64_t fx = x % cell, fy = y % cell, c = cell;
      const auto* const corner = &lattice[static_cast<std::size_t>(y / cell) * columns + x / cell];
      const std::uint64_t top = corner[0] * (c - fx) + corner[1] * fx;
      const std::uint64_t bottom = corner[columns] * (c - fx) + corner[columns + 1] * fx;
      sum[static_cast<std::size_t>(y) * width + x] +=
          static_cast<std::uint32_t>((top * (c - fy) + bottom * fy) / (c * c));
    }
  }
}

inline void draw_natural(Pixels& picture, SplitMix64& noise) {
  std::vector<std::uint32_t> sum(picture.values.size());
  std::uint64_t octaves = 0;
  for (int cell = 1; cell <= std::max(picture.width, picture.height); cell *= 2) {
    add_octave(sum, picture.width, picture.height, cell, noise);
    ++octaves;
  }
  std::transform(sum.begin(), sum.end(), picture.values.begin(), [&](std::uint64_t value) {
    return static_cast<std::uint16_t>(value * picture.largest() / (octaves * 4095));
  });
}

inline std::uint32_t ramp(int x, int y, const Pixels& picture) {
  const std::uint64_t across =
      2 * static_cast<std::uint64_t>(x) * picture.largest() / picture.width;
  const std::uint64_t down = static_cast<std::uint64_t>(y) * picture.largest() / picture.height;
  return static_cast<std::uint32_t>((across + down) / 3);
}

}  // namespace detail

/// Draws one of contents(). bits: 8 or 16. Throws std::invalid_argument for another name.
inline Pixels make_pixels(std::string_view content, int bits, int width, int height,
                          std::uint64_t seed) {
  Pixels picture{width, height, bits, {}};
  picture.values.resize(static_cast<std::size_t>(width) * height);
  SplitMix64 noise(seed);
  const std::uint32_t largest = picture.largest();
  const std::uint32_t level = largest * 7 / 10;
  const auto fill = [&](auto&& grey) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) picture.at(x, y) = static_cast<std::uint16_t>(grey(x, y));
    }
  };
  if (content == "zero") {
    fill([](int, int) { return 0U; });
  } else if (content == "flat") {
    fill([&](int, int) { return level; });
  } else if (content == "full") {
    fill([&](int, int) { return largest; });
  } else if (content == "nearly-flat") {
    fill([&](int, int) { return level - 1 + noise.below(3); });
  } else if (content == "impulse") {
    const int x = static_cast<int>(noise.below(static_cast<std::uint32_t>(width)));
    picture.at(x, static_cast<int>(noise.below(static_cast<std::uint32_t>(height)))) =
        static_cast<std::uint16_t>(largest);
  } else if (content == "ramp") {
    fill([&](int x, int y) { return detail::ramp(x, y, picture); });
  } else if (content == "checkerboard") {
    fill([&](int x, int y) { return (x + y) % 2 == 0 ? 0U : largest; });
  } else if (content == "random") {
    fill([&](int, int) { return noise.below(largest + 1); });
  } else if (content == "binary") {
    fill([&](int, int) { return noise.below(2) == 0 ? 0U : largest; });
  } else if (content == "natural") {
    detail::draw_natural(picture, noise);
  } else {
    throw std::invalid_argument("no picture called " + std::string(content));
  }
  return picture;
}

}  // namespace fathom::test
