// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/world.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "hal/drivers/simulated/compression.hpp"

namespace fathom::simulated {
namespace {

constexpr std::int64_t kFramePeriodNs = 33'333'333;  ///< 30 frames a second.
constexpr std::int64_t kLongestExposureNs = 1'000'000'000;
constexpr std::chrono::milliseconds kLongestPatience = std::chrono::hours(1);

}  // namespace

World::World(const WorldSettings& settings)
    : settings_(settings),
      lamp_(settings.seed, settings.drift),
      sensor_(settings.seed, settings.noise),
      motor_(settings.seed, settings.start_steps, settings.backlash_steps,
             settings.rate_steps_per_s, settings.objective->travel,
             settings.objective->stall_rate) {
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
  return std::clamp(settings_.distance_mm + settings_.speed_mm_per_s * gone_s,
                    objective().nearest_target_mm, objective().farthest_target_mm);
}

double World::distance_mm(double x_px, double y_px) const {
  return is_relief(settings_.target) ? relief().distance_mm(x_px, y_px) : distance_mm();
}

const Relief& World::relief() const {
  const double distance_mm = this->distance_mm();
  if (!relief_ || relief_mm_ != distance_mm) {
    relief_.emplace(settings_.target, settings_.relief, distance_mm, settings_.seed);
    relief_mm_ = distance_mm;
  }
  return *relief_;
}

void World::step(int steps) {
  if (steps != 0) last_step_ns_ = now_ns_ + motor_.step_ns(steps);
  now_ns_ = std::max(now_ns_, last_step_ns_);
  exposing_since_ns_.reset();
  trail_.clear();
}

void World::start(std::vector<int> legs, OnStep on_step) {
  on_step_ = std::move(on_step);
  trail_.forget_before(now_ns_ - kLongestExposureNs);
  trail_.add(now_ns_, motor_.lens());
  if (!legs.empty()) course_.emplace(std::move(legs), now_ns_, motor_.rate());
}

void World::pass_until(std::int64_t time_ns) {
  while (course_ && course_->next_ns() <= time_ns) {
    if (course_->begins_leg()) motor_.begin_move(course_->leg());
    last_step_ns_ = course_->next_ns();
    motor_.make_step(course_->direction());
    on_step_(course_->direction(), last_step_ns_);
    trail_.add(last_step_ns_, motor_.lens());
    course_->advance();
    if (course_->is_over()) course_.reset();
  }
  now_ns_ = std::max(now_ns_, time_ns);
}

/// What the sensor would see of the target with the lens at a place.
const std::vector<float>& World::picture(int lens) {
  const double distance_mm = this->distance_mm();
  if (picture_.empty() || drawn_lens_ != lens || drawn_mm_ != distance_mm) {
    picture_ = drawn(lens, distance_mm);
    drawn_lens_ = lens;
    drawn_mm_ = distance_mm;
  }
  return picture_;
}

std::vector<float> World::drawn(int lens, double distance_mm) {
  if (is_relief(settings_.target)) return relief().picture(lens, settings_.f_number);
  const bool has_grown = objective().breathes && drawn_lens_ != lens;
  if (!former_ || drawn_mm_ != distance_mm || has_grown) {
    scene_ = draw_scene_at(settings_.target, objective().pixel_on_object_mm(lens, distance_mm),
                           settings_.seed);
    former_.emplace(scene_);
  }
  std::vector<double> discs_mm;
  for (const Layer& layer : scene_.layers) {
    discs_mm.push_back(
        objective().disc_mm(lens, distance_mm - layer.in_front_mm(), settings_.f_number));
  }
  return former_->picture(discs_mm);
}

/// Light adds up: the mean of what the places show, each weighted with its share of the time.
std::vector<float> World::smeared(const std::vector<Stay>& stays) {
  std::vector<double> sum(std::size_t{kWidthPx} * kHeightPx);
  for (const Stay& stay : stays) {
    const std::vector<float>& seen = picture(stay.lens);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += stay.share * seen[i];
  }
  return {sum.begin(), sum.end()};
}

Frame World::expose(const Exposure& exposure) {
  const double light = lamp_.light_at(std::midpoint(exposure.start_ns, exposure.end_ns));
  const auto take = [&](std::span<const float> seen) {
    auto pixels = sensor_.expose(seen, light, settings_.exposure_ms, frames_++);
    if (objective().is_compressed) compress(pixels, kWidthPx);
    Frame frame(kWidthPx, kHeightPx, std::move(pixels));
    frame.exposure = exposure;
    return frame;
  };
  if (!is_moving() && !trail_.covers(exposure)) {
    Frame frame = take(picture(motor_.lens()));
    frame.lens_position = motor_.counter();
    return frame;
  }
  const std::vector<Stay> stays = trail_.stays(exposure);
  Frame frame = stays.size() == 1 ? take(picture(stays.front().lens)) : take(smeared(stays));
  double mean = 0;
  for (const Stay& stay : stays) mean += stay.share * stay.lens;
  frame.lens_position = mean;
  return frame;
}

std::optional<Frame> World::grab(std::chrono::milliseconds timeout) {
  const std::int64_t exposure_ns = std::llround(settings_.exposure_ms * 1e6);
  const std::int64_t period_ns = std::max(kFramePeriodNs, exposure_ns);
  const std::int64_t from_ns = std::max(now_ns_, wanted_from_ns_);
  const std::int64_t next_ns = (from_ns + period_ns - 1) / period_ns * period_ns;
  const std::int64_t start_ns = exposing_since_ns_.value_or(next_ns);
  const auto patience = std::clamp(timeout, std::chrono::milliseconds(0), kLongestPatience);
  const std::int64_t deadline_ns = now_ns_ + std::chrono::nanoseconds(patience).count();
  if (start_ns + exposure_ns > deadline_ns) {
    exposing_since_ns_ = start_ns;
    pass_until(deadline_ns);
    return std::nullopt;
  }
  exposing_since_ns_.reset();
  pass_until(start_ns + exposure_ns);
  return expose({start_ns, start_ns + exposure_ns});
}

}  // namespace fathom::simulated
