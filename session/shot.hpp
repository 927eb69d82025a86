// SPDX-License-Identifier: Apache-2.0
// A picture taken at a lens position: move, settle, drop what is stale, average.
#pragma once

#include "../hal/camera.hpp"
#include "../hal/lens.hpp"
#include "../hal/stop.hpp"
#include "observer.hpp"

namespace fathom {

/// How pictures are taken.
struct ShotOptions {
  int average = 1;                          ///< Frames averaged for one picture (thesis T12).
  StopRequests stop_requests = never_stop;  ///< Asked before every move and frame.
};

/// One frame (or the mean of several) at one lens position.
struct Shot {
  Frame frame;
  Arrival arrival;  ///< How the lens got there.
};

/// The next frame whose exposure began at or after `not_before_ns`, or the mean of as many as asked
/// for; of a recording, of as many as it has there. Throws Error(timeout) where none comes, Error(cancelled) after a stop request,
/// Error(bad_data) for a frame of another size than the camera promised.
Frame take_frame(Camera& camera, std::int64_t not_before_ns, const ShotOptions& options);

/// One such frame, whatever is averaged. Throws as take_frame.
Frame take_one(Camera& camera, std::int64_t not_before_ns, const ShotOptions& options);

/// Throws Error(device_lost) for an arrival farther from nearest(wanted) than accuracy_of()
/// (hal/approach.hpp).
void require_arrival(const Lens& lens, double wanted, const Arrival& arrival);

/// Moves and waits until the lens has settled. Throws as Lens::move_to and require_arrival.
Arrival arrive(Lens& lens, double position);

/// Moves, waits and takes a frame. Throws as take_frame and arrive.
Shot shoot(Camera& camera, Lens& lens, double position, const ShotOptions& options);

/// Puts a lens back where it was when the scope ends, also by an exception, unless told to leave
/// it; to the nearest place of its travel, if it was found beyond that.
class LensReturn {
 public:
  explicit LensReturn(Lens& lens) : lens_(lens), start_(lens.nearest(lens.position())) {}
  /// `observer` is told where the lens could not be put back.
  LensReturn(Lens& lens, Observer& observer) : LensReturn(lens) { observer_ = &observer; }
  LensReturn(const LensReturn&) = delete;
  LensReturn& operator=(const LensReturn&) = delete;
  ~LensReturn();

  /// Leave the lens where it will be.
  void release() { armed_ = false; }

 private:
  Lens& lens_;
  double start_;
  Observer* observer_ = nullptr;
  bool armed_ = true;
};

}  // namespace fathom
