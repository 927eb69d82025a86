// SPDX-License-Identifier: Apache-2.0
// The pictures that a map is made of: those of a recording, or of a sweep of a live lens.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/calibration.hpp"
#include "depth/align.hpp"
#include "engine/travel.hpp"
#include "mapping/depth_maker.hpp"
#include "session/rig.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {

using mapping::DepthMaker;

/// What a user says of them.
struct TakingRequest {
  std::string rig;
  std::optional<double> from, to, step;  ///< Of a live sweep.
  /// Of a live sweep without a step: whether few positions will do, four times as many as a coarse
  /// pass takes; else some hundred are taken.
  bool is_coarse = false;
  int average = 1;
  Alignment align = Alignment::similarity;
  bool is_quiet = false;   ///< Whether what was found on opening is left to somebody else to say.
  bool needs_all = false;  ///< Whether some of the frames are of no use.
};

/// Throws Error(bad_argument) for a recording where something is said that is of a sweep alone.
void require_sweep_options(const TakingRequest& request);

/// What is known of them before the first one is taken.
struct StackFacts {
  std::vector<double> positions = {};
  std::string unit = {};  ///< Of positions.
  PictureShape shape = {};
  bool is_live = false;
  bool has_colours = false;
  std::optional<BlurModel> lens_blur = std::nullopt;  ///< Where the lens says it.
  /// From one frame to the next, um, of a recording that knows it.
  std::optional<double> spacing_um = std::nullopt;
};

/// Shows how far the taking is.
class TakingView {
 public:
  virtual ~TakingView() = default;
  /// A frame was added: the number `done` of all.
  virtual void added(const DepthMaker& maker, std::size_t done, std::size_t total) = 0;
  /// Something else is about to be printed.
  virtual void clear() = 0;
};

/// "label ######---- 42 of 100"
class TakingBar final : public TakingView {
 public:
  explicit TakingBar(std::string label) : label_(std::move(label)) {}
  void added(const DepthMaker&, std::size_t done, std::size_t total) override {
    progress_.bar(label_, done, total);
  }
  void clear() override { progress_.clear(); }

 private:
  std::string label_;
  Progress progress_;
};

/// How the picture grows with the lens, where a law of optics says it: for each unit of position, as a
/// part of the first picture.
struct StackGrowth {
  double told = 0;    ///< By the lens or the calibration.
  double fitted = 0;  ///< By the pictures, which begin with that.
};

class Taking {
 public:
  /// Opens the recording or the rig, and says what was found. Throws as either, Error(bad_argument)
  /// for limits and a step that the lens has not, and Error(bad_data) for too few or too many
  /// positions.
  explicit Taking(const TakingRequest& request);

  const StackFacts& facts() const { return facts_; }

  /// The rig; of a recording it is opened when it is asked for.
  Rig& rig();
  /// The same for somebody else: nothing can be taken afterwards.
  Rig release_rig() &&;

  /// What tells how the picture grows with the lens, beside the lens itself.
  void use(const Calibration& calibration) { calibration_ = calibration; }

  /// Takes every picture and adds it; `observer` is told of a live sweep. A lens is put back where it
  /// stood. Ctrl-C ends it: what was taken until then is kept, and said. Throws Error(cancelled) where
  /// that is too little, and as DepthMaker, RecordedStack::read and Session::visit.
  DepthMaker take(const OpenDevice& open, const DepthOptions& options, TakingView& view,
                  Observer& observer);
  DepthMaker take(const OpenDevice& open, const DepthOptions& options, TakingView& view) {
    Observer nobody;
    return take(open, options, view, nobody);
  }

  /// After take(): of an alignment by scale that a law was known for.
  std::optional<StackGrowth> growth() const { return growth_; }
  /// After take(): whether Ctrl-C ended it before its last picture.
  bool was_stopped() const { return was_stopped_; }

 private:
  void describe_recording();
  void open_rig();
  void read_recording(DepthMaker& maker, StackAligner& aligner, TakingView& view);
  void sweep(DepthMaker& maker, StackAligner& aligner, TakingView& view, Observer& observer);
  void require_enough(const DepthMaker& maker) const;
  std::optional<GrowthLaw> growth_law();

  TakingRequest request_;
  StackFacts facts_;
  std::optional<replay::RecordedStack> recording_;
  std::optional<Rig> rig_;
  std::optional<Calibration> calibration_;
  std::optional<StackGrowth> growth_;
  bool was_stopped_ = false;
};

/// "none", "scale", "similarity". Throws Error(bad_argument) for another word.
Alignment parse_alignment(const std::string& text);

/// Reads a calibration whose positions must be in this unit, where it says theirs. Throws
/// Error(bad_argument) where they are not, and as Calibration::parse.
Calibration load_calibration(const std::string& path, const std::string& unit);

}  // namespace fathom::cli
