// SPDX-License-Identifier: Apache-2.0
#include "depth/mapper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "depth/beyond.hpp"
#include "depth/blur_of_stack.hpp"
#include "depth/cascade.hpp"
#include "depth/chance.hpp"
#include "depth/cliffs.hpp"
#include "depth/stack_light.hpp"
#include "depth/upsample.hpp"
#include "engine/error.hpp"
#include "engine/quantile.hpp"

namespace fathom {

using namespace depth;

namespace {

constexpr std::size_t kFewestPositions = 3;
constexpr int kSmallestPicture = 32;

/// Sorted, each once.
std::vector<double> different(std::span<const double> positions) {
  const std::set<double> sorted(positions.begin(), positions.end());
  return {sorted.begin(), sorted.end()};
}

void require_stack(int width_px, int height_px, std::span<const double> positions) {
  if (width_px < kSmallestPicture || height_px < kSmallestPicture) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("pictures of {} x {} px are too small for a map; {} x {} is the least",
                            width_px, height_px, kSmallestPicture, kSmallestPicture));
  }
  if (!std::ranges::all_of(positions, [](double at) { return std::isfinite(at); })) {
    throw Error(ErrorCode::bad_argument, "the position of a picture is not a number");
  }
  if (different(positions).size() < kFewestPositions) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a map needs pictures at {} different positions at least, not {}",
                            kFewestPositions, different(positions).size()));
  }
}

StackBlur stack_blur(const BlurModel& model) {
  require_valid(model);
  return {model.px_per_unit, model.rest_px * model.rest_px, model.shape};
}

BlurModel model_of(const StackBlur& blur) {
  return {.px_per_unit = blur.px_per_unit,
          .rest_px = std::sqrt(std::max(blur.offset_px2, 0.0)),
          .shape = blur.shape};
}

/// Half of the frames are nearer to each other than this, or as near.
double usual_spacing(std::span<const double> sorted) {
  std::vector<double> spacings;
  for (std::size_t i = 1; i < sorted.size(); ++i) spacings.push_back(sorted[i] - sorted[i - 1]);
  return median(std::move(spacings));
}

Scales scales_of(const StackBlur& blur, double spacing, const FocusGrid& grid) {
  constexpr double kApartPx = 1.5, kUnknownPart = 0.048;
  const double apart = std::max(kApartPx / blur.px_per_unit, spacing);
  return {.apart = static_cast<float>(apart / grid.step),
          .least_sigma = static_cast<float>(kUnknownPart * apart / grid.step)};
}

/// Windows that told a place see so far, in the mean, and so far its neighbours are fitted with it.
float reach_of(const Nodes& nodes) {
  double sum = 0, count = 0;
  for (const Peak& peak : nodes.peaks) {
    if (peak.kind != DepthClass::known) continue;
    sum += peak.side_px;
    ++count;
  }
  const double side_px = count > 0 ? sum / count : nodes.level.side_px();
  return static_cast<float>(side_px + 2 * kFittedNodes * nodes.level.pitch_px());
}

}  // namespace

class DepthMapper::Impl {
 public:
  Impl(const OpenDevice& open, int width_px, int height_px, std::span<const double> positions,
       const DepthOptions& options)
      : width_px_(width_px),
        height_px_(height_px),
        positions_(positions.begin(), positions.end()),
        given_(options.blur),
        scoring_(open, plan_levels(width_px, height_px, positions.size(), options),
                 positions.size()),
        threads_(std::max(scoring_.device_threads(), 1)) {
    if (given_) require_valid(*given_);
  }

  void add(std::size_t frame, const Frame& grey, const Similarity& place,
           std::optional<double> gain) {
    require_frame(grey, "a picture of the stack");
    if (frame >= positions_.size()) {
      throw Error(ErrorCode::bad_argument, fmt::format("no position is known of picture {} of {}",
                                                       frame + 1, positions_.size()));
    }
    scoring_.add(frame, grey, {.place = place, .gain = gain ? *gain : light_.add(grey, place)},
                 threads_);
    is_placed_ = is_placed_ || place != Similarity{};
  }

  DepthMaps finish(const Frame* guide) {
    if (guide) require_frame(*guide, "the guide");
    std::vector<std::size_t> frames;
    std::vector<double> positions;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      if (!scoring_.rings(0).has(i)) continue;
      frames.push_back(i);
      positions.push_back(positions_[i]);
    }
    require_stack(width_px_, height_px_, positions);
    const StackBlur blur =
        given_ ? stack_blur(*given_) : fit_blur_of_stack(scoring_, frames, positions, threads_);
    blur_ = model_of(blur);
    const FocusGrid grid = focus_grid(blur, positions);
    const Scales scales = scales_of(blur, usual_spacing(different(positions)), grid);
    const Ends ends(positions, scales.apart * grid.step);
    Nodes nodes = Cascade(scoring_, frames, positions, blur, grid, ends).nodes(threads_);
    doubt_noise({scoring_, frames, positions, blur, grid, ends}, nodes, threads_);
    doubt_beyond(scoring_, frames, ends, nodes);
    if (is_placed_) mark_outside(frames, positions, grid, nodes);
    scoring_.clear();
    doubt_cliffs(scales, nodes);
    const float reach_px = reach_of(nodes);
    const Surface surface = surface_of(nodes, scales, threads_);
    nodes = {};
    DepthMaps maps = upsample(surface, width_px_, height_px_, grid, scales, threads_);
    maps.shared_sigma = scales.least_sigma * static_cast<float>(grid.step);
    maps.reach_px = reach_px;
    return maps;
  }

  const BlurModel& blur() const { return blur_; }

 private:
  void require_frame(const Frame& frame, const char* what) const {
    if (frame.width_px() == width_px_ && frame.height_px() == height_px_) return;
    throw Error(ErrorCode::bad_argument,
                fmt::format("{} is {} x {} px, the map {} x {}", what, frame.width_px(),
                            frame.height_px(), width_px_, height_px_));
  }

  /// Places that fewer than half of the frames show, or not the one that is nearest to the focus.
  void mark_outside(std::span<const std::size_t> frames, std::span<const double> positions,
                    const FocusGrid& grid, Nodes& nodes) const {
    for (std::size_t node = 0; node < nodes.peaks.size(); ++node) {
      const double focus = grid.at(nodes.peaks[node].place);
      std::size_t missing = 0, nearest = 0;
      for (std::size_t i = 0; i < frames.size(); ++i) {
        if (!shows(frames[i], node)) ++missing;
        if (std::abs(positions[i] - focus) < std::abs(positions[nearest] - focus)) nearest = i;
      }
      if (2 * missing > frames.size() || !shows(frames[nearest], node)) {
        nodes.peaks[node].kind = DepthClass::outside;
      }
    }
  }

  bool shows(std::size_t frame, std::size_t node) const {
    float powers[kRings];
    scoring_.rings(0).take(frame, node * kRings, powers);
    return !std::isnan(powers[0]);
  }

  int width_px_, height_px_;
  std::vector<double> positions_;
  std::optional<BlurModel> given_;
  Scoring scoring_;
  int threads_;
  StackLight light_;
  bool is_placed_ = false;
  BlurModel blur_;
};

DepthMapper::DepthMapper(const OpenDevice& open, int width_px, int height_px,
                         std::span<const double> positions, const DepthOptions& options) {
  require_stack(width_px, height_px, positions);
  impl_ = std::make_unique<Impl>(open, width_px, height_px, positions, options);
}

DepthMapper::~DepthMapper() = default;
DepthMapper::DepthMapper(DepthMapper&&) noexcept = default;
DepthMapper& DepthMapper::operator=(DepthMapper&&) noexcept = default;

void DepthMapper::add(std::size_t frame, const Frame& grey, const Similarity& place,
                      std::optional<double> gain) {
  impl_->add(frame, grey, place, gain);
}

DepthMaps DepthMapper::finish(const Frame* guide) { return impl_->finish(guide); }

const BlurModel& DepthMapper::blur() const { return impl_->blur(); }

}  // namespace fathom
