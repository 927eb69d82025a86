// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/mosaic.hpp"

#include <array>

#include "pictures/grey.hpp"

namespace fathom::aravis {
namespace {

/// Where in each square of four pixels red stands, and so blue, and the green of red's row.
struct Corner {
  int x, y;
};

Corner red_of(Mosaic mosaic) {
  switch (mosaic) {
    case Mosaic::rg:
      return {0, 0};
    case Mosaic::gr:
      return {1, 0};
    case Mosaic::gb:
      return {0, 1};
    case Mosaic::bg:
      return {1, 1};
    case Mosaic::none:
      break;
  }
  return {0, 0};
}

Corner corner_of(Mosaic mosaic, MosaicUse use) {
  const Corner red = red_of(mosaic);
  switch (use) {
    case MosaicUse::red:
      return red;
    case MosaicUse::green:
      return {1 - red.x, red.y};
    case MosaicUse::blue:
      return {1 - red.x, 1 - red.y};
    case MosaicUse::luma:
      break;
  }
  return red;
}

enum Colour { red, green, blue };

Colour colour_at(int x, int y, const Corner& of_red) {
  const bool in_red_column = (x & 1) == of_red.x, in_red_row = (y & 1) == of_red.y;
  if (in_red_column != in_red_row) return green;
  return in_red_column ? red : blue;
}

/// Mirrored at the edges, which keeps the colours' order.
int inside(int at, int side) {
  if (at < 0) return -at;
  return at < side ? at : 2 * side - 2 - at;
}

/// Each colour as the pixel itself has it, or else the mean of its neighbours.
template <class Sample>
std::array<Sample, 3> colours_at(const std::vector<Sample>& samples, int x, int y, int width_px,
                                 int height_px, const Corner& of_red) {
  std::array<std::uint32_t, 3> sum{}, count{};
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Colour colour = colour_at(x + dx + 2, y + dy + 2, of_red);
      const auto row = static_cast<std::size_t>(inside(y + dy, height_px));
      sum[colour] += samples[row * width_px + inside(x + dx, width_px)];
      ++count[colour];
    }
  }
  const Colour own = colour_at(x, y, of_red);
  sum[own] = samples[static_cast<std::size_t>(y) * width_px + x];
  count[own] = 1;
  const auto mean = [&](Colour colour) {
    return static_cast<Sample>((sum[colour] + count[colour] / 2) / count[colour]);
  };
  return {mean(red), mean(green), mean(blue)};
}

}  // namespace

template <class Sample>
std::vector<Sample> interpolated(const std::vector<Sample>& samples, int width_px, int height_px,
                                 Mosaic mosaic) {
  const Corner of_red = red_of(mosaic);
  std::vector<Sample> grey;
  grey.reserve(samples.size());
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const auto colours = colours_at(samples, x, y, width_px, height_px, of_red);
      grey.push_back(pictures::luma(colours[red], colours[green], colours[blue]));
    }
  }
  return grey;
}

template <class Sample>
std::vector<Sample> one_colour(const std::vector<Sample>& samples, int width_px,
                               std::pair<int, int> size, Mosaic mosaic, MosaicUse use) {
  const Corner corner = corner_of(mosaic, use);
  std::vector<Sample> grey;
  grey.reserve(static_cast<std::size_t>(size.first) * size.second);
  for (int y = 0; y < size.second; ++y) {
    const std::size_t row = static_cast<std::size_t>(2 * y + corner.y) * width_px;
    for (int x = 0; x < size.first; ++x) grey.push_back(samples[row + 2 * x + corner.x]);
  }
  return grey;
}

template std::vector<std::uint8_t> interpolated(const std::vector<std::uint8_t>&, int, int, Mosaic);
template std::vector<std::uint16_t> interpolated(const std::vector<std::uint16_t>&, int, int,
                                                 Mosaic);
template std::vector<std::uint8_t> one_colour(const std::vector<std::uint8_t>&, int,
                                              std::pair<int, int>, Mosaic, MosaicUse);
template std::vector<std::uint16_t> one_colour(const std::vector<std::uint16_t>&, int,
                                               std::pair<int, int>, Mosaic, MosaicUse);

}  // namespace fathom::aravis
