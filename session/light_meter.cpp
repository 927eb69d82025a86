// SPDX-License-Identifier: Apache-2.0
#include "session/light_meter.hpp"

#include <algorithm>

#include "session/saturation.hpp"

namespace fathom {
namespace {

constexpr double kDark = 0.08;       // mean grey value, of full scale,
constexpr double kNoLight = 0.25;    // and no pixel above this
constexpr double kTooBright = 0.05;  // part of the window's pixels at the maximum
constexpr double kFlicker = 0.03;    // of the mean, from the darkest picture to the brightest
constexpr int kFewestToFlicker = 3;

}  // namespace

void LightMeter::see(const Frame& frame) {
  double sum = 0;
  std::uint32_t highest = 0;
  for (int y = window_.y; y < window_.y + window_.n; ++y) {
    for (int x = window_.x; x < window_.x + window_.n; ++x) {
      sum += frame.at(x, y);
      highest = std::max<std::uint32_t>(highest, frame.at(x, y));
    }
  }
  const double scale = full_scale(frame.depth(), highest);
  const double mean = sum / scale / (static_cast<double>(window_.n) * window_.n);
  least_ = frames_ == 0 ? mean : std::min(least_, mean);
  most_ = std::max(most_, mean);
  sum_ += mean;
  highest_ = std::max(highest_, highest / scale);
  saturated_ = std::max(saturated_, saturated_part(frame, window_));
  ++frames_;
}

std::optional<PoorLight> LightMeter::judge(double exposure_ms) const {
  if (frames_ == 0) return std::nullopt;
  const double mean = sum_ / frames_;
  if (mean < kDark && highest_ < kNoLight) {
    return PoorLight{PoorLight::Kind::dark, mean, exposure_ms};
  }
  if (saturated_ > kTooBright) return PoorLight{PoorLight::Kind::bright, saturated_, exposure_ms};
  const double swing = mean > 0 ? (most_ - least_) / mean : 0;
  if (frames_ >= kFewestToFlicker && swing > kFlicker) {
    return PoorLight{PoorLight::Kind::flickering, swing, exposure_ms};
  }
  return std::nullopt;
}

}  // namespace fathom
