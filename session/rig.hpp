// SPDX-License-Identifier: Apache-2.0
// A camera, a lens and a metric put together: the thing that measures.
//
// One measurement: the lens moves and settles, frames whose exposure began earlier are dropped, the
// next frames are averaged if asked for, the window is scored.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../engine/scorer.hpp"
#include "../focus/blur.hpp"
#include "../hal/rig_driver.hpp"
#include "measurement.hpp"
#include "passing.hpp"
#include "picture_facts.hpp"
#include "ring_reader.hpp"
#include "shot.hpp"

namespace fathom {

/// The metric that a focus is looked for with unless somebody says another: free of brightness, and
/// less of noise than `fft` (docs/metrics.md, "Which metric").
inline constexpr const char* kSearchMetric = "walsh-sequency";

/// How to put a rig together. Texts are those of the command line.
struct RigOptions {
  std::string rig;                     ///< What open_hardware takes.
  std::string metric = kSearchMetric;  ///< What MetricSpec::parse takes.
  std::optional<Window> window;        ///< N x N at the centre when absent.
  std::string backend;                 ///< What select_device takes.
  DeviceOptions device;                ///< How the device is opened.
  ShotOptions shot;
};

/// Told of a frame, or the mean of several, with the score of its window. The frame is only lent.
using FrameSeen = std::function<void(const Frame&, const Arrival&, double score)>;

/// A camera, a lens and what scores their frames, opened together.
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

  /// Goes to `to` without a halt and scores the frames that it takes on the way; the lens has stood
  /// where it begins since since_ns. `made` is told of each, and says whether to go on. Throws as
  /// take_passing().
  Passage measure_passing(double to, std::int64_t since_ns, const PassingRules& rules,
                          const std::function<bool(Measurement)>& made,
                          const FrameSeen& seen = nobody());

  /// From now on measurements have cells of what is round the window, or none.
  void look_round(bool looks) { looks_round_ = looks; }

  /// The window's score in a frame of this camera, wherever the lens stands.
  double score(const Frame& frame) { return scorer_->score(frame); }

  /// The same without what brightness adds: what a search looks at.
  double bare_score(const Frame& frame) { return bare(score(frame), frame); }

  /// Moves to a position and tells the relative scatter of the score over frames taken there (T12);
  /// 0 for a camera that is not live. Throws as measure().
  double repeat_scatter(double position, int frames, const FrameSeen& seen = nobody());

  /// The same, of frames taken where the lens has arrived.
  double repeat_scatter(const Arrival& arrival, int frames, const FrameSeen& seen = nobody());

  /// The relative scatter of what measure() scores in a recording that has several pictures at some
  /// positions, from those within [from, to]: of their means, pooled. 0 where it has none.
  double recorded_scatter(double from, double to, const FrameSeen& seen = nobody());

  /// What was noticed when the hardware was opened; nothing from the second call on.
  std::vector<Finding> take_findings() { return std::exchange(hardware_.findings, {}); }

  /// Camera and lens, as they describe themselves.
  std::string description() { return camera().description() + "; " + lens().info().description; }
  Camera& camera() { return *hardware_.camera; }
  Lens& lens() { return *hardware_.lens; }
  /// Camera, lens and stage for another rig in place of this one, which can do nothing afterwards.
  Hardware release() && { return std::move(hardware_); }
  /// Null unless the rig can place its target itself.
  TargetStage* stage() { return hardware_.stage.get(); }

  /// How the lens blurs, where it says so.
  std::optional<BlurModel> blur();
  /// Whether pictures come with ring powers: those of small windows have none.
  bool has_spectra() const { return rings_->can_read(); }

  const RigOptions& options() const { return options_; }
  const MetricSpec& spec() const { return scorer_->spec(); }
  Window window() const { return scorer_->windows()[0]; }
  const Selection& selection() const { return scorer_->selection(); }

 private:
  static FrameSeen nobody() {
    return [](const Frame&, const Arrival&, double) {};
  }

  /// What a frame gives, of which the lens said this.
  Measurement read(const Frame& frame, const Arrival& arrival, const FrameSeen& seen);

  double bare(double value, const Frame& frame) {
    return BrightnessShare::without(value, share_->of(frame, window()));
  }

  RigOptions options_;
  Hardware hardware_;
  std::optional<Scorer> scorer_;  // always there; made once the camera is open, as these:
  std::optional<BrightnessShare> share_;
  std::optional<PictureReader> reader_;
  std::optional<RingReader> rings_;
  bool looks_round_ = false;
};

}  // namespace fathom
