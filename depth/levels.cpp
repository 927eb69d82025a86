// SPDX-License-Identifier: Apache-2.0
#include "depth/levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "engine/error.hpp"

namespace fathom::depth {
namespace {

/// By itself a map is made of windows of 8 to 64 px.
constexpr int kMostHalvings = 3;
/// What rings of all frames may take, bytes: so much and so much a pixel.
constexpr double kFixedBytes = 40e6, kBytesPerPixel = 18;
/// Windows that a level must have along each axis.
constexpr int kFewestNodes = 3;

Level level_of(int width_px, int height_px, int halvings, int stride_px) {
  Level level{.halvings = halvings,
              .width_px = width_px >> halvings,
              .height_px = height_px >> halvings,
              .stride_px = stride_px};
  level.columns = (level.width_px - kSide) / level.stride_px + 1;
  level.rows = (level.height_px - kSide) / level.stride_px + 1;
  return level;
}

bool has_room(const Level& level) {
  return level.width_px >= kSide && level.height_px >= kSide && level.columns >= kFewestNodes &&
         level.rows >= kFewestNodes;
}

/// Stride within the picture of a level, for one in the whole picture.
int stride_within(int stride, int halvings) {
  constexpr int kUsual = kSide / 2;
  return stride == 0 ? kUsual : std::clamp(stride >> halvings, 1, kSide);
}

/// Halvings after which windows of kSide have this side.
int halvings_of(int side) {
  constexpr int kLargest = 256;
  if (side < kSide || side > kLargest || !std::has_single_bit(static_cast<unsigned>(side))) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("no map is made of windows of {} px; there are 8, 16, 32, 64, 128 and "
                            "256",
                            side));
  }
  return std::countr_zero(static_cast<unsigned>(side)) - std::countr_zero(unsigned{kSide});
}

double bytes_of(const std::vector<Level>& levels, std::size_t frames) {
  double bytes = 0;
  for (const Level& level : levels) bytes += static_cast<double>(level.nodes() * kRings * frames);
  return bytes;
}

std::vector<int> wanted(const DepthOptions& options) {
  std::vector<int> halvings;
  for (const int side : options.sides) halvings.push_back(halvings_of(side));
  if (halvings.empty()) {
    for (int h = 0; h <= kMostHalvings; ++h) halvings.push_back(h);
  }
  std::ranges::sort(halvings);
  halvings.erase(std::unique(halvings.begin(), halvings.end()), halvings.end());
  return halvings;
}

}  // namespace

std::vector<Level> plan_levels(int width_px, int height_px, std::size_t frames,
                               const DepthOptions& options) {
  if (options.stride < 0) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("windows cannot be {} px apart", options.stride));
  }
  std::vector<Level> levels;
  for (const int h : wanted(options)) {
    const Level level = level_of(width_px, height_px, h, stride_within(options.stride, h));
    if (has_room(level)) levels.push_back(level);
  }
  if (levels.empty()) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("pictures of {} x {} px have no room for a grid of these windows",
                            width_px, height_px));
  }
  const double limit = kFixedBytes + kBytesPerPixel * width_px * height_px;
  const bool is_free = options.sides.empty() && options.stride == 0;
  while (is_free && levels.size() > 1 && bytes_of(levels, frames) > limit) {
    levels.erase(levels.begin());
  }
  return levels;
}

}  // namespace fathom::depth
