// SPDX-License-Identifier: Apache-2.0
// A camera, a lens and a metric put together: the thing that measures.
//
// One measurement: the lens moves and settles, frames whose exposure began earlier are dropped, the
// next frames are averaged if asked for, the window is scored.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "../engine/backend.hpp"
#include "../engine/selection.hpp"
#include "../focus/search.hpp"
#include "../hal/rig_driver.hpp"
#include "shot.hpp"

namespace fathom {

/// How to put a rig together. Texts are those of the command line.
struct RigOptions {
  std::string rig;               ///< What open_hardware takes.
  std::string metric = "fft";    ///< What MetricSpec::parse takes.
  std::optional<Window> window;  ///< N x N at the centre when absent.
  std::string backend;           ///< What select_device takes.
  DeviceOptions device;          ///< How the device is opened.
  ShotOptions shot;
};

/// One score at one lens position.
struct Measurement {
  double position = 0;  ///< As Lens::nearest() promised it.
  double score = 0;
  std::int64_t settled_ns = 0;  ///< On the rig's clock, like the times of the move below.
  Exposure exposure;            ///< On the same clock; of the first to the last frame averaged.
  std::string note;
  std::int64_t started_ns = 0;  ///< When the move began
  std::int64_t stopped_ns = 0;  ///< and when the motor stopped.
  std::int64_t compute_ns = 0;  ///< From the frame to the score, on this computer's clock.
  double saturated = 0;         ///< Part of the window's pixels at the maximum, 0..1.
};

/// Where the time of measurements went, s: on the rig's clock, but for computing.
struct TimeSpent {
  double moving = 0, settling = 0;
  double exposing = 0;  ///< From the lens at rest to the last frame's end.
  double computing = 0;
};
TimeSpent time_spent(std::span<const Measurement> measurements);

class Rig {
 public:
  /// Opens hardware and backend. Throws as open_hardware, resolve_window and select_device, and
  /// Error(bad_argument) for an average below 1.
  explicit Rig(const RigOptions& options);

  /// The same with hardware that is open already; options.rig only names it.
  Rig(const RigOptions& options, Hardware hardware);

  /// Moves, waits, takes frames and scores the window. Throws as shoot() and Plan::score.
  Measurement measure(double position);

  /// The window's score in a frame of this camera, wherever the lens stands.
  double score(const Frame& frame) { return plan_->score(frame, window_); }

  /// Moves to a position and tells the relative scatter of the score over frames taken there (T12);
  /// 0 for a camera that is not live. Throws as measure().
  double repeat_scatter(double position, int frames);

  /// What a search may ask of this rig; `log` is told of every measurement.
  Objective objective(std::function<void(const Measurement&)> log);

  /// Camera and lens, as they describe themselves.
  std::string description() { return camera().description() + "; " + lens().info().description; }
  Camera& camera() { return *hardware_.camera; }
  Lens& lens() { return *hardware_.lens; }
  /// Null unless the rig can place its target itself.
  TargetStage* stage() { return hardware_.stage.get(); }

  const RigOptions& options() const { return options_; }
  const MetricSpec& spec() const { return plan_->spec(); }
  const Window& window() const { return window_; }
  const Selection& selection() const { return selection_; }

 private:
  RigOptions options_;
  Hardware hardware_;
  Window window_;
  Selection selection_;  // the device outlives the plan
  std::unique_ptr<Plan> plan_;
};

}  // namespace fathom
