// SPDX-License-Identifier: Apache-2.0
// A camera, a lens and a metric put together: the thing that measures.
//
// One measurement: the lens moves and settles, frames whose exposure began earlier are dropped, the
// next frames are averaged if asked for, the window is scored.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "../engine/scorer.hpp"
#include "../hal/rig_driver.hpp"
#include "measurement.hpp"
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

/// Told of a frame, or the mean of several, with the score of its window. The frame is only lent.
using FrameSeen = std::function<void(const Frame&, const Arrival&, double score)>;

class Rig {
 public:
  /// Opens hardware and backend. Throws as open_hardware, resolve_window and select_device, and
  /// Error(bad_argument) for an average below 1 or a metric that gives several numbers.
  explicit Rig(const RigOptions& options);

  /// The same with hardware that is open already; options.rig only names it.
  Rig(const RigOptions& options, Hardware hardware);

  /// Moves, waits, takes frames and scores the window; `seen` is told of the frame before it is
  /// gone. Throws as shoot() and Plan::score.
  Measurement measure(double position, const FrameSeen& seen = nobody());

  /// The window's score in a frame of this camera, wherever the lens stands.
  double score(const Frame& frame) { return scorer_->score(frame); }

  /// Moves to a position and tells the relative scatter of the score over frames taken there (T12);
  /// 0 for a camera that is not live. Throws as measure().
  double repeat_scatter(double position, int frames, const FrameSeen& seen = nobody());

  /// The same, of frames taken where the lens has arrived.
  double repeat_scatter(const Arrival& arrival, int frames, const FrameSeen& seen = nobody());

  /// Camera and lens, as they describe themselves.
  std::string description() { return camera().description() + "; " + lens().info().description; }
  Camera& camera() { return *hardware_.camera; }
  Lens& lens() { return *hardware_.lens; }
  /// Null unless the rig can place its target itself.
  TargetStage* stage() { return hardware_.stage.get(); }

  const RigOptions& options() const { return options_; }
  const MetricSpec& spec() const { return scorer_->spec(); }
  Window window() const { return scorer_->windows()[0]; }
  const Selection& selection() const { return scorer_->selection(); }

 private:
  static FrameSeen nobody() {
    return [](const Frame&, const Arrival&, double) {};
  }

  RigOptions options_;
  Hardware hardware_;
  std::optional<Scorer> scorer_;  // always there; made once the camera is open
};

}  // namespace fathom
