// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/clock.hpp"

namespace fathom::http {
namespace {

using std::chrono::milliseconds;

/// A service lets nobody wait for longer.
constexpr milliseconds kLongestWait{1000};
constexpr int kNoContent = 204;

template <typename Number>
Number number_in(const Answer& answer, const char* header) {
  const std::string text = answer.header(header);
  char* end = nullptr;
  const auto read = [&] {
    if constexpr (std::is_floating_point_v<Number>) return std::strtod(text.c_str(), &end);
    return static_cast<Number>(std::strtoll(text.c_str(), &end, 10));
  };
  const Number number = read();
  if (!text.empty() && *end == '\0') return number;
  throw Error(ErrorCode::bad_data, fmt::format("a frame comes without what {} should say", header));
}

}  // namespace

std::string HttpCamera::description() const {
  return fmt::format("{} at {}", link_->facts().camera.description, link_->where());
}

Validity HttpCamera::validate(CameraSettings& wished) const {
  const CameraSettings own = settings();
  if (wished == own) return Validity::valid;
  if (!have_meaning(wished) || !std::isfinite(wished.exposure_ms)) return Validity::refused;
  return adjust(wished, own);
}

void HttpCamera::apply(const CameraSettings& settings) {
  CameraSettings wished = settings;
  if (validate(wished) == Validity::valid) return;
  throw Error(ErrorCode::unsupported,
              fmt::format("{}: its settings are made where it is plugged in", description()));
}

milliseconds HttpCamera::patience() const { return link_->facts().camera.patience + kLongestWait; }

void HttpCamera::count(const Answer& answer) {
  const FrameCounts lost{.dropped = number_in<std::uint64_t>(answer, "x-fathom-dropped"),
                         .corrupt = number_in<std::uint64_t>(answer, "x-fathom-corrupt")};
  if (!lost_before_) lost_before_ = lost;
  counts_.dropped = lost.dropped - lost_before_->dropped;
  counts_.corrupt = lost.corrupt - lost_before_->corrupt;
  ++counts_.delivered;
}

std::optional<Frame> HttpCamera::ask_for_frame(milliseconds timeout) {
  const CameraSettings shape = settings();
  constexpr std::size_t kHeadBytes = 64;
  const std::size_t most_bytes = kHeadBytes + static_cast<std::size_t>(shape.width_px) *
                                                  shape.height_px * bytes_per_pixel(shape.depth);
  const Answer answer =
      link_->get(fmt::format("rig/frame?timeout_ms={}", timeout.count()), most_bytes, timeout);
  if (answer.status == kNoContent) return std::nullopt;
  Frame frame = frame_from(answer.body, shape);
  const ClockMap& clock = link_->clock();
  frame.exposure = {
      .start_ns = clock.earliest(number_in<std::int64_t>(answer, "x-fathom-stamp-ns")),
      .end_ns = clock.earliest(number_in<std::int64_t>(answer, "x-fathom-end-ns"))};
  if (!answer.header("x-fathom-position").empty())
    frame.lens_position = number_in<double>(answer, "x-fathom-position");
  count(answer);
  return frame;
}

std::optional<Frame> HttpCamera::grab(milliseconds timeout) {
  const std::int64_t deadline_ns = monotonic_now_ns() + std::chrono::nanoseconds(timeout).count();
  while (true) {
    const std::chrono::nanoseconds left(
        std::max<std::int64_t>(deadline_ns - monotonic_now_ns(), 0));
    const auto wait = std::min(std::chrono::ceil<milliseconds>(left), kLongestWait);
    std::optional<Frame> frame = ask_for_frame(wait);
    if (frame || monotonic_now_ns() >= deadline_ns) return frame;
  }
}

}  // namespace fathom::http
