// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/world.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {
namespace {

constexpr std::int64_t kFramePeriodNs = 33'333'333;  ///< 30 frames a second.
constexpr std::int64_t kSettleNs = 50'000'000;
constexpr std::chrono::milliseconds kLongestPatience = std::chrono::hours(1);

}  // namespace

World::World(const WorldSettings& settings)
    : settings_(settings),
      lamp_(settings.seed, settings.drift),
      sensor_(settings.seed, settings.noise),
      motor_(settings.seed, settings.start_steps, settings.backlash_steps,
             settings.rate_steps_per_s) {
  motor_.lose_in_next_long_move(settings.lose_steps);
}

void World::set_distance_mm(double distance_mm) {
  settings_.distance_mm = distance_mm;
  placed_ns_ = now_ns_;
  former_.reset();
  picture_.clear();
}

double World::distance_mm() const {
  const double gone_s = 1e-9 * static_cast<double>(now_ns_ - placed_ns_);
  return std::clamp(settings_.distance_mm + settings_.speed_mm_per_s * gone_s, kNearestTargetMm,
                    kFarthestTargetMm);
}

void World::step(int steps) {
  now_ns_ += motor_.step_ns(steps);
  exposing_since_ns_.reset();
  picture_.clear();
}

void World::settle() { now_ns_ += kSettleNs; }

const std::vector<float>& World::picture() {
  const double distance_mm = this->distance_mm();
  if (!former_ || drawn_mm_ != distance_mm) {
    scene_ = draw_scene(settings_.target, distance_mm, settings_.seed);
    former_.emplace(scene_);
    drawn_mm_ = distance_mm;
    picture_.clear();
  }
  if (picture_.empty()) {
    std::vector<double> discs_mm;
    for (const Layer& layer : scene_.layers) {
      discs_mm.push_back(disc_of_confusion_mm(motor_.lens(), distance_mm - layer.in_front_mm(),
                                              settings_.f_number));
    }
    picture_ = former_->picture(discs_mm);
  }
  return picture_;
}

std::optional<Frame> World::grab(std::chrono::milliseconds timeout) {
  const std::int64_t exposure_ns = std::llround(settings_.exposure_ms * 1e6);
  const std::int64_t period_ns = std::max(kFramePeriodNs, exposure_ns);
  const std::int64_t next_ns = (now_ns_ + period_ns - 1) / period_ns * period_ns;
  const std::int64_t start_ns = exposing_since_ns_.value_or(next_ns);
  const auto patience = std::clamp(timeout, std::chrono::milliseconds(0), kLongestPatience);
  const std::int64_t deadline_ns = now_ns_ + std::chrono::nanoseconds(patience).count();
  if (start_ns + exposure_ns > deadline_ns) {
    exposing_since_ns_ = start_ns;
    now_ns_ = deadline_ns;
    return std::nullopt;
  }
  exposing_since_ns_.reset();
  now_ns_ = start_ns + exposure_ns;
  const double light = lamp_.light_at(start_ns + exposure_ns / 2);
  Frame frame(kWidthPx, kHeightPx,
              sensor_.expose(picture(), light, settings_.exposure_ms, frames_++));
  frame.exposure = {start_ns, now_ns_};
  frame.lens_position = motor_.counter();
  return frame;
}

}  // namespace fathom::simulated
