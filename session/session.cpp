// SPDX-License-Identifier: Apache-2.0
#include "session/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/error.hpp"
#include "focus/blur_fit.hpp"
#include "focus/searches.hpp"
#include "focus/track.hpp"
#include "session/beside.hpp"
#include "session/doubts.hpp"
#include "session/first_picture.hpp"
#include "session/light_meter.hpp"
#include "session/moving.hpp"
#include "session/rig_objective.hpp"

namespace fathom {
namespace {

void warn_of_inexact(const Lens& lens, const std::vector<double>& wanted, Observer& observer) {
  constexpr double kRounding = 1e-12;  // of a place that was counted in parts of a unit
  InexactPositions inexact;
  for (const double position : wanted) {
    const double nearest = lens.nearest(position);
    if (std::abs(nearest - position) > kRounding * std::abs(position))
      inexact.places.push_back({position, nearest});
  }
  if (inexact.places.empty()) return;
  inexact.unit = lens.info().unit;
  observer.warned(inexact);
}

/// Whether there is no larger window than this in the camera's pictures.
bool is_largest_window(Rig& rig) {
  const CameraSettings picture = rig.camera().settings();
  const int larger = 2 * rig.window().n;
  return larger > kLargestWindow || larger > std::min(picture.width_px, picture.height_px);
}

/// What a user said, in the order of the travel; the rest of the positions is the search's affair.
std::vector<double> asked_for(const FocusLimits& limits) {
  if (limits.bracket) return {limits.from, limits.bracket->inner, limits.to};
  return {limits.from, limits.to};
}

/// The scatter of kRepeatFrames frames at one place, which are looked at for their light as well;
/// the lens may say something of the way there.
double repeated(Rig& rig, double position, Run& run, Observer& observer) {
  const Arrival arrival = arrive(rig.lens(), rig.lens().nearest(position));
  if (!arrival.note.empty()) observer.warned(LensNote{arrival.position, arrival.note});
  LightMeter light(rig.window());
  const FrameSeen tell = told_to(observer);
  const FrameSeen seen = [&](const Frame& frame, const Arrival& where, double score) {
    light.see(frame);
    tell(frame, where, score);
  };
  run.started_ns = arrival.started_ns;
  run.repeats = kRepeatFrames;
  const double scatter = rig.repeat_scatter(arrival, kRepeatFrames, seen);
  if (const auto poor = light.judge(rig.camera().settings().exposure_ms)) observer.warned(*poor);
  return scatter;
}

/// How far scores repeat: of a live camera by taking one place again and again, of a recording by
/// what it has of its places.
double scatter_of(Rig& rig, const FocusLimits& limits, bool at_start, Run& run,
                  Observer& observer) {
  if (!rig.camera().is_live())
    return rig.recorded_scatter(limits.from, limits.to, told_to(observer));
  return repeated(rig, at_start ? limits.start : limits.from, run, observer);
}

void tell_findings(Rig& rig, Observer& observer) {
  for (const Finding& finding : rig.take_findings()) observer.warned(finding);
}

/// Frames that a camera lost since this was made.
class LossWatch {
 public:
  explicit LossWatch(Camera& camera) : camera_(camera), before_(camera.counts()) {}

  void tell(Observer& observer) const {
    const FrameCounts lost = during();
    if (lost.dropped + lost.corrupt > 0) observer.warned(LostFrames{lost});
  }

  /// Of all frames, 0..1.
  double lost_part() const {
    const FrameCounts all = during();
    const auto lost = static_cast<double>(all.dropped + all.corrupt);
    return lost > 0 ? lost / (lost + static_cast<double>(all.delivered)) : 0;
  }

 private:
  FrameCounts during() const {
    const FrameCounts now = camera_.counts();
    return {now.delivered - before_.delivered, now.dropped - before_.dropped,
            now.corrupt - before_.corrupt};
  }

  Camera& camera_;
  FrameCounts before_;
};

void conclude(Run& run, Focus focus, const LensInfo& lens, const LossWatch& losses,
              Observer& observer) {
  run.lost_part = losses.lost_part();
  run.focus = std::move(focus);
  doubt_for_losses(*run.focus, run.lost_part);
  doubt_for_resemblance(*run.focus, run.resemblance);
  doubt_for_first_look(*run.focus, run.first_look, run.start_position.value_or(0));
  observer.found(*run.focus);
  tell_doubts(run.measurements, *run.focus, lens, observer);
  losses.tell(observer);
}

/// A picture of where the lens stands, before it goes elsewhere.
PictureAt picture_here(Rig& rig) {
  const double here = rig.lens().nearest(rig.lens().position());
  Shot shot = shoot(rig.camera(), rig.lens(), here, rig.options().shot);
  return {here, std::move(shot.frame)};
}

/// What the lens's optics say counts for more than what somebody said.
std::optional<BlurKnown> blur_known(Rig& rig, const std::optional<BlurModel>& asked) {
  const std::optional<BlurModel> told = rig.blur();
  if (!asked && !told) return std::nullopt;
  const BlurModel model = asked.value_or(*told);
  return BlurKnown{model, told && model == *told && rig.lens().info().optics};
}

/// Whether the picture from before the search fits what it found.
std::optional<FirstLook> first_look(Rig& rig, const Run& run, const Focus& focus,
                                    const TopKeeper& top, const BlurKnown& known) {
  const std::optional<PictureAt> sharp = top.best();
  if (!top.first() || !sharp) return std::nullopt;
  const auto& beside = top.beside_first();
  return look_at_first_picture({*sharp, *top.first(), beside ? &*beside : nullptr}, rig.window(),
                               focus.position(), known, run.evaluations_at_rest());
}

/// Says where the pictures of a search contradict the blur that it was told.
void doubt_blur(const Run& run, const LensInfo& lens, Observer& observer) {
  const Focus& focus = *run.focus;
  if (!run.limits->blur) return;
  const BlurModel& used = *run.limits->blur;
  const bool misled = focus.spectral_end == SpectralEnd::does_not_defocus;
  if (misled && run.limits->most_pictures > 0) {  // too few to learn another from
    observer.warned(
        BlurDoubted{.used = used.px_per_unit, .seen = {}, .was_misled = false, .unit = lens.unit});
    return;
  }
  if (focus.result() != FocusResult::focused) return;
  const std::vector<Evaluation> all = run.evaluations_at_rest();
  if (!misled && !is_doubtful(all, used, focus.position())) return;
  const auto fit = fit_blur(all, {.focus = focus.position()});
  const bool is_other = fit && !agree(fit->model, used);
  if (!is_other && !misled) return;
  BlurDoubted doubted{.used = used.px_per_unit,
                      .seen = {},
                      .was_misled = focus.spectral_end != SpectralEnd::found,
                      .unit = lens.unit};
  if (is_other) doubted.seen = fit->model.px_per_unit;
  observer.warned(doubted);
}

[[noreturn]] void refuse_spectra(const Window& window) {
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("a search by spectra looks at windows of 32 to 256 px, and this one has {}; "
                  "take another window, or search otherwise",
                  window.n));
}

void require_passable(Rig& rig) {
  const LensInfo lens = rig.lens().info();
  if (!rig.lens().can_be_watched()) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} cannot be watched while it moves: {}; it can only be swept with a "
                            "halt at every position",
                            lens.description, rig.lens().why_unwatched()));
  }
  require_watching_camera(rig);
}

/// Mean distance of neighbours; of one position, boundless.
double spacing_of(const std::vector<double>& positions) {
  if (positions.size() < 2) return std::numeric_limits<double>::infinity();
  return (positions.back() - positions.front()) / static_cast<double>(positions.size() - 1);
}

/// What a picture may smear without showing: less than a pixel's blur, where the lens tells that,
/// and no more than two positions of the sweep.
PassingRules passing_rules(Rig& rig, double apart, double spacing) {
  constexpr double kMostPx = 1;
  const std::optional<BlurModel> blur = rig.blur();
  const double unseen = blur ? blur->units(kMostPx) : 2 * spacing;
  return {.apart = apart, .most_smear = std::min(unseen, 2 * spacing), .most_sigma = spacing};
}

/// Those of the positions that nothing was evaluated near to.
std::vector<double> missed_of(const std::vector<double>& positions, double spacing,
                              const std::vector<Evaluation>& evaluations) {
  std::vector<double> missed;
  for (const double position : positions) {
    const bool is_seen = std::any_of(
        evaluations.begin(), evaluations.end(),
        [&](const Evaluation& e) { return std::abs(e.position - position) <= spacing; });
    if (!is_seen) missed.push_back(position);
  }
  return missed;
}

}  // namespace

Run Session::focus(const FocusRequest& request, Observer& observer) {
  require_moving(rig_, request);
  FocusRequest here = request;
  // A recording has no travel to spare; its pictures are searched by spectra where somebody says so.
  const bool is_wanted = here.frames || here.search == SearchMethod::spectral;
  if (!here.blur && (is_wanted || rig_.camera().is_live())) here.blur = rig_.blur();
  if (!rig_.has_spectra()) {
    if (is_wanted) refuse_spectra(rig_.window());
    here.blur.reset();
  }
  const bool by_spectra = here.blur && here.search == SearchMethod::automatic;
  const bool at_start = by_spectra || search_of(request.search).begins_at_start;
  if (at_start && !here.start) here.start = rig_.lens().position();
  Run run;
  tell_findings(rig_, observer);
  run.limits = resolve_limits(here, rig_.lens().info());
  run.limits->is_live = rig_.camera().is_live();
  run.limits->largest_window = is_largest_window(rig_);
  run.limits->moves = moves(rig_, request, *run.limits, observer);
  rig_.look_round(run.limits->returns);
  warn_of_inexact(rig_.lens(), asked_for(*run.limits), observer);
  const LossWatch losses(rig_.camera());
  run.start_position = rig_.lens().position();
  TopKeeper top(rig_.window());
  const auto known = run.limits->is_live && !request.frames ? blur_known(rig_, here.blur)
                                                            : std::optional<BlurKnown>();
  // A search that begins where the lens stands takes such a picture anyway.
  if (known && !at_start) top.begin_with(picture_here(rig_));
  // With a budget every frame is worth too much to be repeated.
  if (!request.frames) run.repeat_scatter = scatter_of(rig_, *run.limits, at_start, run, observer);
  observer.began(run, 0);
  Observer nobody;
  Observers watchers{run.limits->is_live ? static_cast<Observer*>(&top) : &nobody, &observer};
  RigObjective objective(rig_, run, watchers);
  Focus focus = search_focus(objective.objective(), *run.limits, rig_.spec(), run.repeat_scatter);
  if (const auto why = objective.why_halted()) observer.warned(HaltsInstead{*why});
  // With a budget no two pictures need show the same.
  if (focus.result() == FocusResult::focused && !request.frames)
    run.resemblance = run.limits->is_live ? top.resemblance() : compare_beside(rig_, focus);
  if (known && focus.result() == FocusResult::focused)
    run.first_look = first_look(rig_, run, focus, top, *known);
  conclude(run, std::move(focus), rig_.lens().info(), losses, observer);
  doubt_blur(run, rig_.lens().info(), observer);
  return run;
}

Run Session::track(const Run& before, Observer& observer) {
  // An observer may keep its runs, `before` among them, where began() moves them.
  const Focus last = before.focus.value();
  const std::vector<Sighting> seen = before.sightings();
  Run run;
  run.limits = before.limits.value();
  run.repeat_scatter = before.repeat_scatter;
  run.tracks = run.by_time = true;
  const LossWatch losses(rig_.camera());
  observer.began(run, 0);
  RigObjective objective(rig_, run, observer);
  conclude(run,
           track_focus({objective.objective(), [&] { return middle_s(run.measurements.back()); }},
                       *run.limits, rig_.spec(), run.repeat_scatter, last, seen),
           rig_.lens().info(), losses, observer);
  return run;
}

Run Session::sweep(const Sweep& sweep, Observer& observer) {
  const LensInfo lens = rig_.lens().info();
  const FocusLimits limits = resolve_limits(FocusRequest::within(sweep.from, sweep.to), lens);
  if (sweep.step && *sweep.step > 0 && *sweep.step < lens.resolution)
    observer.warned(StepTooFine{*sweep.step, lens.resolution, lens.unit});
  const std::vector<double> positions = sweep_positions(lens, limits.from, limits.to, sweep.step);
  if (sweep.is_moving) return pass(positions, sweep.step.value_or(0), observer);
  return visit(positions, observer);
}

/// positions: of the sweep with halts that this one takes the place of.
Run Session::pass(const std::vector<double>& positions, double apart, Observer& observer) {
  require_passable(rig_);
  tell_findings(rig_, observer);
  warn_of_inexact(rig_.lens(), {positions.front(), positions.back()}, observer);
  const LossWatch losses(rig_.camera());
  Run run;
  run.start_position = rig_.lens().position();
  const Arrival start = arrive(rig_.lens(), positions.front());
  run.started_ns = start.started_ns;
  observer.began(run, 0);
  const auto made = [&](Measurement one) {
    if (run.measurements.empty()) one.started_ns = start.started_ns;  // the way to here is its own
    observer.evaluated(run.measurements.emplace_back(std::move(one)));
    return true;
  };
  const double spacing = spacing_of(positions);
  const Passage left_out =
      rig_.measure_passing(positions.back(), start.settled_ns, passing_rules(rig_, apart, spacing),
                           made, told_to(observer));
  const std::vector<double> missed = missed_of(positions, spacing, run.evaluations());
  if (left_out.unplaced > 0 || left_out.smeared > 0 || !missed.empty()) {
    observer.warned(FewOnTheWay{.unplaced = left_out.unplaced,
                                .smeared = left_out.smeared,
                                .visited = static_cast<int>(missed.size())});
  }
  RigObjective halting(rig_, run, observer);
  for (const double position : missed) halting.score(position);
  tell_doubts(run.measurements, best_of(run.evaluations()).position, observer);
  losses.tell(observer);
  return run;
}

Run Session::visit(const std::vector<double>& positions, Observer& observer) {
  tell_findings(rig_, observer);
  warn_of_inexact(rig_.lens(), positions, observer);
  const LossWatch losses(rig_.camera());
  Run run;
  run.start_position = rig_.lens().position();
  observer.began(run, positions.size());
  RigObjective objective(rig_, run, observer);
  for (const double position : positions) objective.score(rig_.lens().nearest(position));
  if (!positions.empty())
    tell_doubts(run.measurements, best_of(run.evaluations()).position, observer);
  losses.tell(observer);
  return run;
}

}  // namespace fathom
