// SPDX-License-Identifier: Apache-2.0
#include "pictures/exif.hpp"

#include <cstring>
#include <string_view>
#include <utility>

namespace fathom::pictures {
namespace {

using namespace std::string_view_literals;

/// The TIFF that an EXIF segment holds; what lies beyond its end reads as 0.
class ExifBytes {
 public:
  explicit ExifBytes(std::span<const std::uint8_t> bytes)
      : bytes_(bytes), big_endian_(at(0) == 'M') {}

  std::uint32_t number(std::size_t offset, int count) const {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) {
      const int place = big_endian_ ? count - 1 - i : i;
      value |= at(offset + static_cast<std::size_t>(i)) << (8 * place);
    }
    return value;
  }

 private:
  std::uint32_t at(std::size_t offset) const { return offset < bytes_.size() ? bytes_[offset] : 0; }

  std::span<const std::uint8_t> bytes_;
  bool big_endian_;
};

}  // namespace

std::optional<int> exif_orientation(std::span<const std::uint8_t> segment) {
  constexpr auto kMark = "Exif\0\0"sv;
  constexpr std::uint32_t kOrientation = 0x0112, kShort = 3;
  constexpr std::size_t kEntry = 12;
  if (segment.size() < kMark.size() || std::memcmp(segment.data(), kMark.data(), kMark.size()) != 0)
    return std::nullopt;
  const ExifBytes exif(segment.subspan(kMark.size()));
  const std::size_t directory = exif.number(4, 4);
  const std::size_t entries = exif.number(directory, 2);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + i * kEntry;
    if (exif.number(entry, 2) != kOrientation) continue;
    const std::uint32_t value = exif.number(entry + 8, 2);
    if (exif.number(entry + 2, 2) != kShort || value < 1 || value > 8) return std::nullopt;
    return static_cast<int>(value);
  }
  return std::nullopt;
}

std::vector<std::uint8_t> turned_upright(std::vector<std::uint8_t> stored, int width_px,
                                         int height_px, int channels, int orientation) {
  if (orientation == kUpright) return stored;
  const auto width = static_cast<std::size_t>(width_px);
  const auto height = static_cast<std::size_t>(height_px);
  // EXIF says which sides of the scene the first row and the first column are.
  const bool from_right =
      orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool from_bottom =
      orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  const bool on_side = lies_on_its_side(orientation);
  std::vector<std::uint8_t> seen(stored.size());
  std::size_t to = 0;
  for (std::size_t y = 0; y < (on_side ? width : height); ++y) {
    for (std::size_t x = 0; x < (on_side ? height : width); ++x) {
      std::size_t column = on_side ? y : x;
      std::size_t row = on_side ? x : y;
      if (from_right) column = width - 1 - column;
      if (from_bottom) row = height - 1 - row;
      const std::size_t from = (row * width + column) * static_cast<std::size_t>(channels);
      for (int c = 0; c < channels; ++c) seen[to++] = stored[from + static_cast<std::size_t>(c)];
    }
  }
  return seen;
}

}  // namespace fathom::pictures
