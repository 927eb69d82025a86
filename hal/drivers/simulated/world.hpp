// SPDX-License-Identifier: Apache-2.0
// What the simulated camera, lens and stage share: one scene, one motor, one clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/frame.hpp"
#include "hal/drivers/simulated/image_former.hpp"
#include "hal/drivers/simulated/motor.hpp"
#include "hal/drivers/simulated/scene.hpp"
#include "hal/drivers/simulated/sensor.hpp"

namespace fathom::simulated {

inline constexpr double kNearestTargetMm = 1230;
inline constexpr double kFarthestTargetMm = 10000;

/// How a rig is set up; the keys of the driver.
struct WorldSettings {
  Target target = Target::usaf;
  double distance_mm = 1800;
  double f_number = 4;
  double exposure_ms = kNormalExposureMs;
  std::uint64_t seed = 1989;
  double noise = 1;
  double drift = 1;
  int start_steps = 0;
  int backlash_steps = 4;
  double rate_steps_per_s = 25;
  double speed_mm_per_s = 0;  ///< Of the target, away from the lens.
  int lose_steps = 0;
};

/// The rig and the room it stands in. Time is the simulation's own: it passes only while the motor
/// turns and the camera waits or exposes, so that a run takes no longer than its arithmetic.
class World {
 public:
  explicit World(const WorldSettings& settings);

  const WorldSettings& settings() const { return settings_; }
  const Motor& motor() const { return motor_; }
  std::int64_t now_ns() const { return now_ns_; }

  void set_exposure_ms(double exposure_ms) { settings_.exposure_ms = exposure_ms; }
  /// Puts the target there now; it is drawn again when it is next looked at.
  void set_distance_mm(double distance_mm);
  /// Where the target is now. One that moves stops where the stage ends.
  double distance_mm() const;

  /// Makes steps, while time passes. A frame that was being exposed is discarded.
  void step(int steps);
  /// Declares where the lens is.
  void set_counter(int position) { motor_.set_counter(position); }
  /// Lets vibrations die away.
  void settle();

  /// The next frame of a camera that runs at 30 frames a second, or slower where the exposure takes
  /// longer; nothing if it does not end within the timeout, which then has passed.
  std::optional<Frame> grab(std::chrono::milliseconds timeout);

 private:
  const std::vector<float>& picture();

  WorldSettings settings_;
  Lamp lamp_;
  Sensor sensor_;
  Motor motor_;
  std::int64_t now_ns_ = 0;
  std::int64_t placed_ns_ = 0;  ///< When the target was put at settings().distance_mm.
  double drawn_mm_ = 0;         ///< Where it was when it was last drawn.
  std::uint64_t frames_ = 0;
  std::optional<std::int64_t>
      exposing_since_ns_;  ///< Start of a frame that a grab did not wait for.
  Scene scene_;
  std::optional<ImageFormer> former_;  ///< Of the scene; absent until it is looked at.
  std::vector<float> picture_;         ///< Without noise; empty when lens or target have moved.
};

}  // namespace fathom::simulated
