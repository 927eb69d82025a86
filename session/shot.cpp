// SPDX-License-Identifier: Apache-2.0
#include "session/shot.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "engine/error.hpp"
#include "hal/approach.hpp"

namespace fathom {
namespace {

/// A camera that keeps sending frames from before the move is not keeping the contract's clock.
constexpr int kMostStaleFrames = 1000;

void require_wanted(const ShotOptions& options) {
  if (options.stop_requests() > 0) throw Error(ErrorCode::cancelled, "stopped on request");
}

Frame fresh_frame(Camera& camera, std::int64_t not_before_ns, const ShotOptions& options) {
  const CameraSettings promised = camera.settings();
  const auto timeout =
      camera.patience() +
      std::chrono::milliseconds(static_cast<std::int64_t>(std::ceil(promised.exposure_ms)));
  for (int stale = 0; stale < kMostStaleFrames; ++stale) {
    require_wanted(options);
    std::optional<Frame> frame = camera.grab(timeout);
    if (!frame) {
      throw Error(ErrorCode::timeout,
                  fmt::format("{}: no frame within {} ms; is it connected and free?",
                              camera.description(), timeout.count()));
    }
    if (frame->exposure.start_ns < not_before_ns) continue;
    if (frame->width_px() != promised.width_px || frame->height_px() != promised.height_px) {
      throw Error(ErrorCode::bad_data,
                  fmt::format("{}: a frame of {} x {} px among frames of {} x {} px",
                              camera.description(), frame->width_px(), frame->height_px(),
                              promised.width_px, promised.height_px));
    }
    return std::move(*frame);
  }
  throw Error(
      ErrorCode::timeout,
      fmt::format(
          "{}: {} frames in a row were exposed before the lens had settled; does it send fresh "
          "ones?",
          camera.description(), kMostStaleFrames));
}

}  // namespace

Frame take_one(Camera& camera, std::int64_t not_before_ns, const ShotOptions& options) {
  return fresh_frame(camera, not_before_ns, options);
}

Frame take_frame(Camera& camera, std::int64_t not_before_ns, const ShotOptions& options) {
  // A recording gives the same pictures again: their mean is all that it has.
  const int count = camera.is_live() ? options.average : camera.recorded_here();
  if (count == 1) return fresh_frame(camera, not_before_ns, options);
  FrameAverage average;
  for (int i = 0; i < count; ++i) average.add(fresh_frame(camera, not_before_ns, options));
  return average.mean();
}

/// A lens that is blocked, or that another program moves, must not pass for one that arrived. One
/// that comes to rest a step beside its goal has arrived: not every motor can do better.
void require_arrival(const Lens& lens, double wanted, const Arrival& arrival) {
  const LensInfo info = lens.info();
  const double promised = nearest_position(info, wanted);
  if (std::abs(arrival.position - promised) <= accuracy_of(info)) return;
  throw Error(ErrorCode::device_lost,
              fmt::format("the lens stands at {} {} though it was sent to {}; is it blocked, or "
                          "does another program move it?",
                          arrival.position, info.unit, promised));
}

Arrival arrive(Lens& lens, double position) {
  Arrival arrival = lens.move_to(position);
  require_arrival(lens, position, arrival);
  return arrival;
}

Shot shoot(Camera& camera, Lens& lens, double position, const ShotOptions& options) {
  require_wanted(options);
  const Arrival arrival = arrive(lens, position);
  return {take_frame(camera, arrival.settled_ns, options), arrival};
}

LensReturn::~LensReturn() {
  if (!armed_) return;
  try {
    try {
      lens_.move_to(start_);
    } catch (const std::exception& error) {
      if (observer_ != nullptr) observer_->warned(LensNotReturned{start_, error.what()});
    }
  } catch (...) {  // no destructor throws, whatever became of what should be said
  }
}

}  // namespace fathom
