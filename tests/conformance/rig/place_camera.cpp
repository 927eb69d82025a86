// SPDX-License-Identifier: Apache-2.0
#include "place_camera.hpp"

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/clock.hpp"

namespace fathom::test {
namespace {

constexpr int kLargest_px = 64;
constexpr double kShortest_ms = 1, kLongest_ms = 20;

}  // namespace

Validity PlaceCamera::validate(CameraSettings& wished) const {
  if (wished.width_px <= 0 || wished.height_px <= 0 || !(wished.exposure_ms > 0)) {
    return Validity::refused;
  }
  const CameraSettings possible{std::min(wished.width_px, kLargest_px),
                                std::min(wished.height_px, kLargest_px), Depth::bits16,
                                std::clamp(wished.exposure_ms, kShortest_ms, kLongest_ms)};
  return adjust(wished, possible);
}

void PlaceCamera::apply(const CameraSettings& settings) {
  CameraSettings checked = settings;
  if (validate(checked) != Validity::valid) {
    throw Error(ErrorCode::unsupported, "the " + description_ + " cannot do that");
  }
  settings_ = settings;
}

std::optional<Frame> PlaceCamera::grab(std::chrono::milliseconds timeout) {
  const std::int64_t exposure_ns = std::llround(settings_.exposure_ms * 1e6);
  if (exposure_ns > std::chrono::nanoseconds(timeout).count()) return std::nullopt;
  Exposure exposure{monotonic_now_ns(), 0};
  sleep_until_ns(exposure.start_ns + exposure_ns);
  exposure.end_ns = monotonic_now_ns();
  const double place = mean_(exposure);
  const auto grey = static_cast<std::uint16_t>(std::lround(200 + 100 * place));
  const std::size_t pixels = static_cast<std::size_t>(settings_.width_px) * settings_.height_px;
  Frame frame(settings_.width_px, settings_.height_px, std::vector<std::uint16_t>(pixels, grey));
  frame.exposure = exposure;
  frame.lens_position = place;
  return frame;
}

}  // namespace fathom::test
