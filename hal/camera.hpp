// SPDX-License-Identifier: Apache-2.0
// The contract of a camera.
//
// Frames and time. A camera gives frames, each stamped with when its exposure began and ended on
// the rig's monotonic clock, the same clock on which the lens says when it has settled:
// CLOCK_MONOTONIC for everything real (hal/clock.hpp). The rig (session/shot.hpp) drops a frame
// whose exposure began before the lens had settled, so a camera with frames queued is safe as long
// as its stamps are honest. A stamp that is not exact must be early, never late: then a good frame
// is dropped now and then, and a blurred one is never scored. A camera with a clock of its own
// (GigE Vision, a USB camera's SOF counter) converts it; one that only knows when the data arrived
// subtracts readout, exposure and whatever it may have had in its queue.
//
// What is not a frame. A buffer that the driver marks as corrupt, that is too short, or that does
// not decode, is counted and never given out; frames that the camera says it lost are counted. See
// FrameCounts.
//
// Waiting. grab() is the only call that waits for light, and no longer than it is told. Nothing in
// that time is a normal answer; an Error means that waiting longer would not help: the camera was
// unplugged, or its stream broke. Then destroy it and open it again through its driver: a camera
// does not come back to life by itself, because whoever measures with it must know.
//
// Settings are asked for, then checked: a camera answers that a wish is valid, that it has been
// adjusted to the nearest that the camera can do, or that it is refused. Nothing is changed in
// silence. What a rig file asks for and the camera cannot keep is an Error at opening.
//
// Grey values. 8 bits go into Depth::bits8; 9 to 16 into Depth::bits16 as they are, in the low
// bits, not stretched: 0 to 1023 of a 10-bit camera. Colour becomes luma; a colour mosaic that
// nobody has interpolated is grey with a pattern, which adds a floor to every score, the same at
// every focus.
//
// What it leaves. Whatever changes exposure, gain, white balance or focus by itself is switched off
// while the camera is open and given back as it was found when it is destroyed, also by an
// exception and after Ctrl-C. One thread uses a camera at a time.
#pragma once

#include <chrono>
#include <cstdint>
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

/// What became of the frames since the camera was opened.
struct FrameCounts {
  std::uint64_t delivered = 0;  ///< Given out by grab().
  std::uint64_t dropped = 0;    ///< Lost before they reached this program.
  std::uint64_t corrupt = 0;    ///< Arrived damaged, and thrown away.

  bool operator==(const FrameCounts&) const = default;
};

/// What gives frames. One thread uses it at a time; drivers make them (RigDriver::open).
class Camera {
 public:
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// One line for logs and run files: driver, model.
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

  /// Whether frames come by themselves, one after the other; else each is made when it is asked for.
  virtual bool streams() const { return false; }

  /// How many pictures a recording has of the place where the lens stands; grab() gives them in
  /// turn, and their mean is what a measurement there scores. 1 for a live camera.
  virtual int recorded_here() const { return 1; }

  /// How long beyond its exposure a frame may take to come before the camera counts as silent.
  virtual std::chrono::milliseconds patience() const { return std::chrono::seconds(5); }

  /// Frames whose exposure begins before this time of the rig's clock will not be looked at. A hint
  /// to a camera that takes trouble over each: grab() need not give them, and may.
  virtual void skip_until([[maybe_unused]] std::int64_t time_ns) {}

  /// All zero for a camera that cannot lose a frame.
  virtual FrameCounts counts() const { return {}; }

  /// The next frame, or nothing if none came within the timeout (0: only what is there already).
  /// The frame owns its pixels or views a buffer of the camera that stays until the next grab.
  /// Throws Error(io), Error(bad_data) or Error(device_lost) where waiting longer would not help,
  /// Error(cancelled) where a stop is requested during a long exposure.
  virtual std::optional<Frame> grab(std::chrono::milliseconds timeout) = 0;

 protected:
  Camera() = default;
};

}  // namespace fathom
