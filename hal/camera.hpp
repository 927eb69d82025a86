// SPDX-License-Identifier: Apache-2.0
// The contract of a camera.
//
// A camera gives frames, each stamped with when its exposure began and ended on the rig's monotonic
// clock, the same clock on which the lens says when it has settled. The rig (ranging/rig.hpp) drops
// a frame whose exposure began before that, so a camera with frames queued is safe as long as its
// stamps are honest.
//
// Settings are asked for, then checked: a camera answers that a wish is valid, that it has been
// adjusted to the nearest that the camera can do, or that it is refused. Nothing is changed in
// silence.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "../engine/frame.hpp"

namespace fathom {

/// What a camera can be asked for.
struct CameraSettings {
  int width_px = 0;
  int height_px = 0;
  Depth depth = Depth::bits8;
  double exposure_ms = 0;  ///< 0 where the camera has no exposure of its own (a replayed stack).

  bool operator==(const CameraSettings&) const = default;
};

/// How a camera takes settings.
enum class Validity {
  valid,     ///< As they are.
  adjusted,  ///< The settings were changed to the nearest that the camera can do.
  refused,   ///< They have no meaning (a negative exposure); nothing was changed.
};

class Camera {
 public:
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// One line for logs and records: driver, model.
  virtual std::string description() const = 0;

  /// The settings in force.
  virtual CameraSettings settings() const = 0;

  /// Checks wished settings and, if it answers `adjusted`, changes them to what apply() would set.
  virtual Validity validate(CameraSettings& wished) const = 0;

  /// Puts settings in force. Throws Error(unsupported) unless validate() calls them valid.
  virtual void apply(const CameraSettings& settings) = 0;

  /// Whether two frames of a still scene differ by noise. A replayed stack gives the same frame
  /// again, so its repeatability cannot be measured by taking it twice.
  virtual bool is_live() const = 0;

  /// The next frame, or nothing if none came within the timeout. The frame owns its pixels or views
  /// a buffer of the camera that stays until the next grab. Throws Error(io), Error(bad_data) or
  /// Error(device_lost) where waiting longer would not help.
  virtual std::optional<Frame> grab(std::chrono::milliseconds timeout) = 0;

 protected:
  Camera() = default;
};

}  // namespace fathom
