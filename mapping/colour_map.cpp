// SPDX-License-Identifier: Apache-2.0
#include "mapping/colour_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/letters.hpp"

namespace fathom::mapping {
namespace {

constexpr std::array<Rgb, 9> kViridis = {{{0x44, 0x01, 0x54},
                                          {0x47, 0x2d, 0x7b},
                                          {0x3b, 0x52, 0x8b},
                                          {0x2c, 0x72, 0x8e},
                                          {0x21, 0x91, 0x8c},
                                          {0x28, 0xae, 0x80},
                                          {0x5e, 0xc9, 0x62},
                                          {0xad, 0xdc, 0x30},
                                          {0xfd, 0xe7, 0x25}}};

/// Values of the palette: depths below, then what is none, paper and ink.
constexpr int kShades = 253;
constexpr std::uint8_t kNone = 253, kPaper = 254, kInk = 255;

std::vector<Rgb> depth_palette() {
  std::vector<Rgb> palette;
  for (int i = 0; i < kShades; ++i) palette.push_back(viridis(i / (kShades - 1.0)));
  palette.push_back({0x80, 0x80, 0x80});
  palette.push_back({0xff, 0xff, 0xff});
  palette.push_back({0x00, 0x00, 0x00});
  return palette;
}

std::uint8_t shade_of(double depth, double low, double high) {
  if (std::isnan(depth)) return kNone;
  const double part = high > low ? (depth - low) / (high - low) : 0.5;
  return static_cast<std::uint8_t>(std::lround(std::clamp(part, 0.0, 1.0) * (kShades - 1)));
}

/// Number of digits behind the point that tell two ends of a scale apart.
std::string scale_number(double value, double low, double high) {
  const double range = std::max(high - low, 1e-12);
  const int digits = std::clamp(static_cast<int>(std::ceil(1.5 - std::log10(range))), 0, 6);
  return fmt::format("{:.{}f}", value, digits);
}

/// What stands beside the map.
struct Scale {
  int zoom;    // px of a letter's dot
  int bar_px;  // width of the bar
  int width_px;
  int top_px, height_px;

  /// letters: of the longest number, or of the unit.
  Scale(int map_height_px, std::size_t letters) {
    zoom = std::max(1, map_height_px / 360);
    bar_px = 8 * zoom;
    const int text_px = static_cast<int>(letters) * kLetterPitch * zoom;
    width_px = 4 * zoom + bar_px + 4 * zoom + text_px;
    top_px = std::min(14 * zoom, map_height_px / 4);
    height_px = std::max(1, map_height_px - 2 * top_px);
  }
};

void draw_scale(PalettePicture& picture, int left, const Scale& scale, double low, double high,
                const std::string& unit) {
  const Canvas canvas{picture.values.data(), picture.width_px, picture.height_px};
  const int bar = left + 4 * scale.zoom, text = bar + scale.bar_px + 3 * scale.zoom;
  for (int y = 0; y < scale.height_px; ++y) {
    const double part = 1 - y / std::max(scale.height_px - 1.0, 1.0);
    canvas.fill(bar, scale.top_px + y, scale.bar_px, 1, shade_of(part, 0, 1));
  }
  constexpr int kMarks = 5;
  for (int i = 0; i < kMarks; ++i) {
    const double part = i / (kMarks - 1.0);
    const int y = scale.top_px + static_cast<int>(std::lround((1 - part) * (scale.height_px - 1)));
    canvas.fill(bar + scale.bar_px, y, 2 * scale.zoom, scale.zoom, kInk);
    canvas.write(text, y - kLetterHeight * scale.zoom / 2,
                 scale_number(low + part * (high - low), low, high), scale.zoom, kInk);
  }
  canvas.write(bar, std::max(0, scale.top_px - (kLetterHeight + 6) * scale.zoom), unit, scale.zoom,
               kInk);
}

}  // namespace

Rgb viridis(double part) {
  const double place = std::clamp(part, 0.0, 1.0) * (kViridis.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kViridis.size() - 2);
  const double t = place - static_cast<double>(i);
  Rgb colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] = static_cast<std::uint8_t>(
        std::lround(kViridis[i][c] + t * (kViridis[i + 1][c] - kViridis[i][c])));
  }
  return colour;
}

PalettePicture coloured(const DepthMaps& maps, double low, double high, const std::string& unit) {
  const Scale scale(maps.height_px, std::max({scale_number(low, low, high).size(),
                                              scale_number(high, low, high).size(), unit.size()}));
  PalettePicture picture{.width_px = maps.width_px + scale.width_px,
                         .height_px = maps.height_px,
                         .values = {},
                         .palette = depth_palette()};
  picture.values.assign(std::size_t{1} * picture.width_px * picture.height_px, kPaper);
  for (int y = 0; y < maps.height_px; ++y) {
    const float* const depths = maps.position.data() + std::size_t{1} * y * maps.width_px;
    std::uint8_t* const row = picture.values.data() + std::size_t{1} * y * picture.width_px;
    for (int x = 0; x < maps.width_px; ++x) row[x] = shade_of(depths[x], low, high);
  }
  if (std::isfinite(low) && std::isfinite(high))
    draw_scale(picture, maps.width_px, scale, low, high, unit);
  return picture;
}

Rgb colour_of(DepthClass value) {
  switch (value) {
    case DepthClass::known:
      return {0x21, 0x91, 0x8c};
    case DepthClass::filled:
      return {0xad, 0xdc, 0x30};
    case DepthClass::no_texture:
      return {0x9e, 0x9e, 0x9e};
    case DepthClass::two_depths:
      return {0xd9, 0x5f, 0x02};
    case DepthClass::at_end:
      return {0x75, 0x70, 0xb3};
    case DepthClass::outside:
      return {0x00, 0x00, 0x00};
  }
  return {};
}

PalettePicture classes_of(const DepthMaps& maps) {
  PalettePicture picture{
      .width_px = maps.width_px, .height_px = maps.height_px, .values = {}, .palette = {}};
  picture.values.reserve(maps.classes.size());
  for (const DepthClass value : maps.classes)
    picture.values.push_back(static_cast<std::uint8_t>(value));
  for (const DepthClass value : kAllDepthClasses) picture.palette.push_back(colour_of(value));
  return picture;
}

namespace {

/// How much the depth changes from one place to the next, or 0 where that is not known.
float step_between(float before, float after) {
  const float step = after - before;
  return std::isnan(step) ? 0.0F : step;
}

/// A slope that nine in ten places do not exceed, of some places of the map.
double usual_slope(const DepthMaps& maps) {
  std::vector<float> slopes;
  const int every = std::max(
      1, static_cast<int>(std::sqrt(static_cast<double>(maps.classes.size()) / 100'000.0)));
  for (int y = 2; y < maps.height_px - 2; y += every) {
    const float* const row = maps.position.data() + std::size_t{1} * y * maps.width_px;
    for (int x = 2; x < maps.width_px - 2; x += every) {
      const float across = row[x + 2] - row[x - 2];
      const float down = row[x + 2 * maps.width_px] - row[x - 2 * maps.width_px];
      const float slope = std::hypot(across, down) / 4;
      if (std::isfinite(slope) && slope > 0) slopes.push_back(slope);
    }
  }
  if (slopes.empty()) return 1;
  const auto ninth = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() * 9 / 10);
  std::nth_element(slopes.begin(), ninth, slopes.end());
  return *ninth;
}

}  // namespace

std::vector<std::uint8_t> shaded(const DepthMaps& maps, bool rises) {
  constexpr float kSteep = 1.0F;  // the usual slope is shown as 45 degrees
  constexpr float kLight[3] = {-0.5F, -0.5F, 0.7071F};
  const float height = (rises ? kSteep : -kSteep) / static_cast<float>(usual_slope(maps)) / 4;
  const int w = maps.width_px, h = maps.height_px;
  std::vector<std::uint8_t> result(maps.classes.size(), 128);
  for (int y = 0; y < h; ++y) {
    const auto row = [&](int line) {
      return maps.position.data() + std::size_t{1} * std::clamp(line, 0, h - 1) * w;
    };
    const float *const above = row(y - 2), *const here = row(y), *const below = row(y + 2);
    for (int x = 0; x < w; ++x) {
      if (std::isnan(here[x])) continue;
      const float dx =
          height * step_between(here[std::max(x - 2, 0)], here[std::min(x + 2, w - 1)]);
      const float dy = height * step_between(above[x], below[x]);
      const float light =
          (kLight[2] - dx * kLight[0] - dy * kLight[1]) / std::sqrt(1 + dx * dx + dy * dy);
      result[std::size_t{1} * y * w + x] =
          static_cast<std::uint8_t>(255 * std::clamp(light, 0.0F, 1.0F));
    }
  }
  return result;
}

}  // namespace fathom::mapping
