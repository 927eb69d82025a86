// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/depth/taking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "mapping/growth_law.hpp"
#include "mapping/stack_taker.hpp"
#include "mapping/survey.hpp"
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/picture_rig.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/warning_notes.hpp"
#include "words/finding_words.hpp"

namespace fathom::cli {

using namespace mapping;
namespace {

constexpr std::size_t kFewestFrames = 3;
constexpr std::size_t kMostFrames = 65536;  // index.tif counts in 16 bits

/// What a stack must have to tell a depth, said before it is read.
void require_stack(std::size_t frames) {
  if (frames < kFewestFrames) {
    throw Error(ErrorCode::bad_data,
                fmt::format("a depth takes {} positions at least, and this rig has {}; capture "
                            "more pictures between the nearest and the farthest focus",
                            kFewestFrames, frames));
  }
  if (frames > kMostFrames) {
    throw Error(ErrorCode::bad_data, fmt::format("{} frames are more than the {} that a map can "
                                                 "count; choose a larger --step",
                                                 frames, kMostFrames));
  }
}

void note_unit(const std::string& unit) {
  if (unit != "frames") return;
  note(
      "positions are not known: depth counts frames from the first one, 0 (a manifest.csv beside "
      "the pictures says where each was taken)");
}

std::vector<double> positions_of(const TakingRequest& request, const LensInfo& lens) {
  const FocusLimits limits = resolve_limits(FocusRequest::within(request.from, request.to), lens);
  auto step = checked_step(request.step);
  if (!step && request.is_coarse) step = coarse_step(lens, limits);
  return sweep_positions(lens, limits.from, limits.to, step);
}

class SweepTaker final : public StackTaker {
 public:
  SweepTaker(DepthMaker& maker, StackAligner& aligner, std::size_t total, TakingView& view)
      : StackTaker(maker, aligner), total_(total), view_(view) {}

  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) override {
    StackTaker::frame(frame, arrival, scores);
    view_.added(maker(), taken(), total_);
  }
  void warned(const Warning&) override { view_.clear(); }

 private:
  std::size_t total_;
  TakingView& view_;
};

}  // namespace

void require_sweep_options(const TakingRequest& request) {
  const bool has_some = request.from || request.to || request.step || request.average != 1;
  if (!has_some || played_by(request.rig).empty()) return;
  throw Error(ErrorCode::bad_argument,
              "--from, --to, --step and --average are for a sweep; of a recording all pictures are "
              "taken");
}

Taking::Taking(const TakingRequest& request) : request_(request) {
  recording_ = replay::open_recording(request.rig);
  recording_ ? describe_recording() : open_rig();
  require_stack(facts_.positions.size());
  if (!request_.is_quiet) note_unit(facts_.unit);
}

void Taking::describe_recording() {
  if (!request_.is_quiet) {
    for (const Finding& finding : recording_->findings()) note(words_for(finding));
  }
  facts_ = {.positions = recording_->positions(),
            .unit = recording_->unit(),
            .shape = recording_->shape(),
            .is_live = false,
            .has_colours = recording_->is_colour()};
  if (facts_.unit == "um") facts_.spacing_um = recording_->resolution();
}

void Taking::open_rig() {
  rig_.emplace(open_picture_rig(request_.rig, request_.average));
  const LensInfo lens = rig_->lens().info();
  const CameraSettings picture = rig_->camera().settings();
  facts_ = {.positions = positions_of(request_, lens),
            .unit = lens.unit,
            .shape = {picture.width_px, picture.height_px, picture.depth},
            .is_live = true,
            .lens_blur = rig_->blur()};
}

Rig& Taking::rig() {
  if (!rig_) rig_.emplace(open_picture_rig(request_.rig, request_.average));
  return *rig_;
}

Rig Taking::release_rig() && {
  rig();
  return *std::move(rig_);
}

std::optional<GrowthLaw> Taking::growth_law() {
  GrowthWitnesses told = {.calibration = calibration_, .lens_blur = facts_.lens_blur};
  if (rig_) told.optics = rig_->lens().info().optics;
  return mapping::growth_law(request_.align, told, facts_.positions);
}

DepthMaker Taking::take(const OpenDevice& open, const DepthOptions& options, TakingView& view,
                        Observer& observer) {
  DepthMaker maker(open, facts_.shape, facts_.has_colours, facts_.positions, options);
  const auto law = growth_law();
  StackAligner aligner(request_.align, law);
  recording_ ? read_recording(maker, aligner, view) : sweep(maker, aligner, view, observer);
  view.clear();
  if (law) growth_ = StackGrowth{.told = law->per_unit, .fitted = *aligner.growth_per_unit()};
  require_enough(maker);
  was_stopped_ = maker.added() < facts_.positions.size();
  return maker;
}

void Taking::require_enough(const DepthMaker& maker) const {
  const std::size_t all = facts_.positions.size();
  if (maker.added() == all) return;
  const std::string seen = fmt::format("stopped after {} of {} frames", maker.added(), all);
  if (request_.needs_all || maker.added() < kFewestFrames) throw Error(ErrorCode::cancelled, seen);
  note(seen + "; the map is of these");
}

void Taking::read_recording(DepthMaker& maker, StackAligner& aligner, TakingView& view) {
  read_stack(*recording_, aligner, maker, [&](std::size_t done, std::size_t total) {
    view.added(maker, done, total);
    return !stop_requested();
  });
}

void Taking::sweep(DepthMaker& maker, StackAligner& aligner, TakingView& view, Observer& observer) {
  try {
    WarningNotes notes;
    LensReturn put_back(rig_->lens(), notes);
    SweepTaker taker(maker, aligner, facts_.positions.size(), view);
    Observers all({&observer, &taker, &notes});
    Session(*rig_).visit(facts_.positions, all);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) throw;
  }
}

Alignment parse_alignment(const std::string& text) {
  for (const Alignment alignment : {Alignment::none, Alignment::scale, Alignment::similarity}) {
    if (text == to_string(alignment)) return alignment;
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("--align {}: there are none, scale and similarity", text));
}

Calibration load_calibration(const std::string& path, const std::string& unit) {
  constexpr std::uintmax_t kLargest = 64 << 20;
  Calibration calibration = Calibration::parse(read_file(path, kLargest), path);
  const CalibrationConditions& made = calibration.conditions();
  if (made.has_other_unit(unit)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("the calibration has positions in {}, this rig counts {}; calibrate "
                            "this rig, or leave --calibration out",
                            made.unit, unit));
  }
  return calibration;
}

}  // namespace fathom::cli
