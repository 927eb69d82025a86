// SPDX-License-Identifier: Apache-2.0
#include "mapping/depth_maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "engine/error.hpp"

namespace fathom::mapping {
namespace {

/// So many curves that a page stays small, however many frames there are.
CurveGrid curve_grid(const PictureShape& shape, std::size_t frames) {
  constexpr double kMostNumbers = 300'000;
  constexpr int kMostColumns = 96, kSmallestCell = 8;
  const double cells = kMostNumbers / static_cast<double>(std::max<std::size_t>(frames, 1));
  const double aspect = static_cast<double>(shape.height_px) / shape.width_px;
  const int most = std::min(kMostColumns, std::max(1, shape.width_px / kSmallestCell));
  CurveGrid grid;
  grid.columns = std::clamp(static_cast<int>(std::sqrt(cells / aspect)), 1, most);
  grid.rows = std::max(1, static_cast<int>(std::lround(grid.columns * aspect)));
  grid.rows = std::min(grid.rows, std::max(1, shape.height_px / kSmallestCell));
  return grid;
}

}  // namespace

DepthMaker::DepthMaker(const OpenDevice& open, const PictureShape& shape, bool has_colours,
                       std::vector<double> positions, const DepthOptions& options)
    : positions_(std::move(positions)),
      mapper_(open, shape.width_px, shape.height_px, positions_, options),
      sharp_(shape.width_px, shape.height_px, shape.depth, has_colours),
      curves_(curve_grid(shape, positions_.size())) {}

void DepthMaker::add(std::size_t frame, const ColourPicture& picture) {
  // The blend takes one thread, the scores what is left.
  const Seen seen{.place = picture.place, .gain = light_.add(picture.grey, picture.place)};
  auto blended = std::async(std::launch::async, [&] { blend(frame, picture, seen.gain); });
  map(frame, picture.grey, seen);
  blended.get();
}

void DepthMaker::add_mean(std::size_t frame, const Frame& mean, const Similarity& place) {
  map(frame, mean, {.place = place, .gain = light_.add(mean, place)});
}

void DepthMaker::blend(std::size_t frame, const ColourPicture& picture) {
  blend(frame, picture, light_.add(picture.grey, picture.place));
}

void DepthMaker::map(std::size_t frame, const Frame& grey, const Seen& seen) {
  mapper_.add(frame, grey, seen.place, seen.gain);
  seen_at_.push_back(positions_[frame]);
  seen_.push_back(seen);
  const Similarity& place = seen.place;
  const double reach = 0.5 * std::hypot(grey.width_px(), grey.height_px());
  const double grown = std::hypot(place.scale * std::cos(place.angle_rad) - 1,
                                  place.scale * std::sin(place.angle_rad));
  moved_px_ = reach * grown + std::hypot(place.dx_px, place.dy_px);
}

void DepthMaker::blend(std::size_t frame, const ColourPicture& picture, double gain) {
  sharp_.add(frame, picture.grey, picture.colours, picture.place, gain);
  curves_.frames.push_back(sharp_.energies(curves_.columns, curves_.rows));
}

DepthResult DepthMaker::finish(bool is_filled) {
  DepthResult result;
  result.sharp = sharp_.finish();
  result.maps = mapper_.finish(&result.sharp.grey);
  if (is_filled) fill(result.maps, &result.sharp.grey);
  result.curves = std::move(curves_);
  result.positions = std::move(seen_at_);
  result.seen = std::move(seen_);
  result.blur = mapper_.blur();
  return result;
}

namespace {

/// Pictures of luma alone among those in colour would leave grey patches in the sharp picture.
void require_alike(replay::RecordedStack& stack, std::size_t index, const Colours& colours) {
  const bool is_colour = stack.is_colour();
  if (colours.empty() != is_colour) return;
  throw Error(
      ErrorCode::bad_data,
      fmt::format("the frames of a stack must be all in colour or all grey, but {} is {} and "
                  "{} is {}",
                  stack.names()[0], is_colour ? "in colour" : "grey", stack.names()[index],
                  is_colour ? "grey" : "in colour"));
}

/// All pictures of one position: one, nearly always.
void add_position(replay::RecordedStack& stack, std::size_t index, ColourPicture first,
                  DepthMaker& maker) {
  const std::size_t count = stack.pictures_at(index);
  if (count == 1) return maker.add(index, first);
  FrameAverage average;
  for (std::size_t which = 0; which < count; ++which) {
    if (which > 0) first.grey = stack.read(index, which, first.colours);
    require_alike(stack, index, first.colours);
    average.add(first.grey);
    maker.blend(index, first);
  }
  maker.add_mean(index, average.mean(), first.place);
}

}  // namespace

void read_stack(replay::RecordedStack& stack, StackAligner& aligner, DepthMaker& maker,
                const FramesDone& done) {
  const std::size_t total = stack.positions().size();
  const auto read = [&stack, &aligner](std::size_t index) {
    ColourPicture picture;
    picture.grey = stack.read(index, 0, picture.colours);
    require_alike(stack, index, picture.colours);
    picture.place = aligner.add(picture.grey);
    return picture;
  };
  ColourPicture current = read(0);
  for (std::size_t i = 0; i < total; ++i) {
    std::future<ColourPicture> next;
    // One thread reads at a time: the file of several pictures of one place is the same.
    const bool reads_ahead = i + 1 < total && stack.pictures_at(i) == 1;
    if (reads_ahead) next = std::async(std::launch::async, read, i + 1);
    add_position(stack, i, std::move(current), maker);
    if (!done(i + 1, total)) return;
    if (i + 1 < total) current = reads_ahead ? next.get() : read(i + 1);
  }
}

}  // namespace fathom::mapping
