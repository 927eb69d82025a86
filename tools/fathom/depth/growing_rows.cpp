// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/depth/growing_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mapping/colour_map.hpp"
#include "mapping/growing.hpp"

namespace fathom::cli {

using namespace mapping;
namespace {

/// Frames from `first` up to `end`.
struct Range {
  int first = 0, end = 0;
};

struct Blocks {
  int columns = 0, rows = 0;
  std::vector<int> sharpest;  ///< Row by row.
};

/// Blocks of a shape that fits, of this picture.
Blocks blocks_that_fit(const CurveGrid& curves, int columns, int rows) {
  columns = std::clamp(columns, 1, curves.columns);
  const double aspect = static_cast<double>(curves.rows) / curves.columns;
  // What is too high is made narrower, so that its shape stays.
  const double wanted = columns * aspect / 2;
  if (wanted > rows) columns = std::max(1, static_cast<int>(columns * rows / wanted));
  const int fitting = std::min(std::max(rows, 1), curves.rows);
  return {columns, std::clamp(static_cast<int>(std::lround(columns * aspect / 2)), 1, fitting), {}};
}

/// From which frame to which most blocks are sharpest.
Range range_of(const Blocks& blocks) {
  constexpr std::size_t kRim = 20;  // One in so many at either end is passed over.
  std::vector<int> frames;
  std::ranges::copy_if(blocks.sharpest, std::back_inserter(frames),
                       [](int frame) { return frame != kNoFrame; });
  if (frames.empty()) return {};
  std::ranges::sort(frames);
  return {frames[frames.size() / kRim], frames[frames.size() - 1 - frames.size() / kRim] + 1};
}

char digit_of(int frame, const Range& range) {
  constexpr int kLast = 9;
  if (frame == kNoFrame) return '.';
  const int digit = kLast * (frame - range.first) / std::max(range.end - 1 - range.first, 1);
  return static_cast<char>('0' + std::clamp(digit, 0, kLast));
}

}  // namespace

std::vector<std::string> growing_rows(const CurveGrid& curves, int columns, int rows) {
  Blocks blocks = blocks_that_fit(curves, columns, rows);
  blocks.sharpest = sharpest_frames(curves, blocks.columns, blocks.rows);
  const Range range = range_of(blocks);
  std::vector<std::string> lines(static_cast<std::size_t>(blocks.rows));
  for (std::size_t i = 0; i < blocks.sharpest.size(); ++i)
    lines[i / blocks.columns] += digit_of(blocks.sharpest[i], range);
  return lines;
}

std::string coloured_digits(const std::string& digits) {
  // The cube of 6 x 6 x 6 colours, which nearly all terminals have.
  constexpr int kLevels = 5, kWhite = 255, kCube = 16, kDigits = 9;
  std::string text;
  for (const char digit : digits) {
    if (digit < '0' || digit > '9') {
      text += fmt::format("\033[0m{}", digit);
      continue;
    }
    const Rgb rgb = viridis(static_cast<double>(digit - '0') / kDigits);
    const auto level = [&](int channel) { return (rgb[channel] * kLevels + kWhite / 2) / kWhite; };
    text += fmt::format("\033[38;5;{}m{}", kCube + 36 * level(0) + 6 * level(1) + level(2), digit);
  }
  return text + "\033[0m";
}

}  // namespace fathom::cli
