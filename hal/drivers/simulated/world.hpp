// SPDX-License-Identifier: Apache-2.0
// What the simulated camera, lens and stage share: one scene, one motor, one clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "engine/frame.hpp"
#include "hal/drivers/simulated/course.hpp"
#include "hal/drivers/simulated/image_former.hpp"
#include "hal/drivers/simulated/motor.hpp"
#include "hal/drivers/simulated/objective.hpp"
#include "hal/drivers/simulated/relief.hpp"
#include "hal/drivers/simulated/scene.hpp"
#include "hal/drivers/simulated/sensor.hpp"
#include "hal/drivers/simulated/trail.hpp"

namespace fathom::simulated {

/// How a rig is set up; the keys of the driver.
struct WorldSettings {
  const Objective* objective = &thesis_objective();
  Target target = Target::usaf;
  ReliefShape relief = {};
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
  bool tells_optics = true;  ///< What few real lenses do.
};

/// The rig and the room it stands in. Time is the simulation's own: it passes only while the motor
/// turns and the camera waits or exposes, so that a run takes no longer than its arithmetic.
///
/// A lens that is sent on a course moves while time passes for any other reason: the camera's, as a
/// rule. What the camera sees then is the mean of what it would see from every place where the lens
/// stood during the exposure, each for as long as it stood there.
class World {
 public:
  explicit World(const WorldSettings& settings);

  const WorldSettings& settings() const { return settings_; }
  const Motor& motor() const { return motor_; }
  const Objective& objective() const { return *settings_.objective; }
  std::int64_t now_ns() const { return now_ns_; }

  void set_exposure_ms(double exposure_ms) { settings_.exposure_ms = exposure_ms; }
  /// Puts the target there now; it is drawn again when it is next looked at.
  void set_distance_mm(double distance_mm);
  /// Where the target is now. One that moves stops where the stage ends.
  double distance_mm() const;

  /// Where what a place of the picture shows is now: elsewhere only for targets of relief.hpp.
  double distance_mm(double x_px, double y_px) const;

  /// Makes steps, while time passes. A frame that was being exposed is discarded. Only at rest.
  void step(int steps);

  using OnStep = std::function<void(int direction, std::int64_t time_ns)>;
  /// Sends the lens on its way; `legs` as in Course. `on_step` is told of every step.
  void start(std::vector<int> legs, OnStep on_step);
  /// The steps that are still to come are not made.
  void halt() { course_.reset(); }
  bool is_moving() const { return course_.has_value(); }
  /// Lets time pass until then, in which the lens goes on; not at all if it has passed.
  void pass_until(std::int64_t time_ns);
  /// Lets time pass until the lens has made its next step; only while it moves.
  void pass_step() { pass_until(course_->next_ns()); }
  /// When the motor last made a step; 0 before the first.
  std::int64_t last_step_ns() const { return last_step_ns_; }

  /// Declares where the lens is.
  void set_counter(int position) { motor_.set_counter(position); }
  /// How long vibrations take to die away, and letting them.
  static constexpr std::int64_t kSettleNs = 50'000'000;
  void settle() { pass_until(now_ns_ + kSettleNs); }

  /// The next frame of a camera that runs at 30 frames a second, or slower where the exposure takes
  /// longer; nothing if it does not end within the timeout, which then has passed.
  std::optional<Frame> grab(std::chrono::milliseconds timeout);
  /// Frames that begin before then are not drawn, nor given out.
  void skip_until(std::int64_t time_ns) { wanted_from_ns_ = time_ns; }

 private:
  const std::vector<float>& picture(int lens);
  std::vector<float> drawn(int lens, double distance_mm);
  const Relief& relief() const;
  std::vector<float> smeared(const std::vector<Stay>& stays);
  Frame expose(const Exposure& exposure);

  WorldSettings settings_;
  Lamp lamp_;
  Sensor sensor_;
  Motor motor_;
  std::optional<Course> course_;  ///< While the lens is on its way.
  OnStep on_step_;
  Trail trail_;
  std::int64_t now_ns_ = 0;
  std::int64_t last_step_ns_ = 0;
  std::int64_t placed_ns_ = 0;  ///< When the target was put at settings().distance_mm.
  double drawn_mm_ = 0;         ///< Where it was when it was last drawn.
  std::uint64_t frames_ = 0;
  std::int64_t wanted_from_ns_ = 0;
  /// Start of a frame that a grab did not wait for.
  std::optional<std::int64_t> exposing_since_ns_;
  Scene scene_;
  mutable std::optional<Relief> relief_;  ///< The target where it is one; absent until asked for.
  mutable double relief_mm_ = 0;          ///< Where it was then.
  std::optional<ImageFormer> former_;     ///< Of the scene; absent until it is looked at.
  std::vector<float> picture_;            ///< Without noise; empty when the target has moved.
  int drawn_lens_ = 0;                    ///< Where the lens stood for it.
};

}  // namespace fathom::simulated
