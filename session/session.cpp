// SPDX-License-Identifier: Apache-2.0
#include "session/session.hpp"

#include "focus/searches.hpp"
#include "focus/track.hpp"
#include "session/saturation.hpp"

namespace fathom {
namespace {

void warn_of_inexact(const Lens& lens, const std::vector<double>& wanted, Observer& observer) {
  InexactPositions inexact;
  for (const double position : wanted) {
    const double nearest = lens.nearest(position);
    if (nearest != position) inexact.places.push_back({position, nearest});
  }
  if (inexact.places.empty()) return;
  inexact.unit = lens.info().unit;
  observer.warned(inexact);
}

/// What a user said, in the order of the travel; the rest of the positions is the search's affair.
std::vector<double> asked_for(const FocusLimits& limits) {
  if (limits.bracket) return {limits.from, limits.bracket->inner, limits.to};
  return {limits.from, limits.to};
}

FrameSeen seen_by(Observer& observer) {
  return [&observer](const Frame& frame, const Arrival& arrival, double score) {
    observer.frame(frame, arrival, {&score, 1});
  };
}

/// The scatter of kRepeatFrames frames at one place; the lens may say something of the way there.
double repeated(Rig& rig, double position, Observer& observer) {
  const Arrival arrival = arrive(rig.lens(), rig.lens().nearest(position));
  if (!arrival.note.empty()) observer.warned(LensNote{arrival.position, arrival.note});
  return rig.repeat_scatter(arrival, kRepeatFrames, seen_by(observer));
}

double evaluate(Rig& rig, double position, Run& run, Observer& observer) {
  const Measurement& made = run.measurements.emplace_back(rig.measure(position, seen_by(observer)));
  observer.evaluated(made);
  if (!made.note.empty()) observer.warned(LensNote{made.position, made.note});
  return made.score;
}

Objective objective_of(Rig& rig, Run& run, Observer& observer) {
  return {[&](double position) { return evaluate(rig, position, run, observer); },
          [&](double position) { return rig.lens().nearest(position); }};
}

/// Frames that a camera lost since this was made.
class LossWatch {
 public:
  explicit LossWatch(Camera& camera) : camera_(camera), before_(camera.counts()) {}

  void tell(Observer& observer) const {
    const FrameCounts now = camera_.counts();
    const FrameCounts during{now.delivered - before_.delivered, now.dropped - before_.dropped,
                             now.corrupt - before_.corrupt};
    if (during.dropped + during.corrupt > 0) observer.warned(LostFrames{during});
  }

 private:
  Camera& camera_;
  FrameCounts before_;
};

void tell_doubts(const Run& run, double position, const LossWatch& losses, Observer& observer) {
  if (const auto saturation = saturation_at(run.measurements, position))
    observer.warned(*saturation);
  losses.tell(observer);
}

void conclude(Run& run, Focus focus, const LossWatch& losses, Observer& observer) {
  run.focus = std::move(focus);
  observer.found(*run.focus);
  tell_doubts(run, run.focus->position(), losses, observer);
}

}  // namespace

Run Session::focus(const FocusRequest& request, Observer& observer) {
  const bool at_start = search_of(request.search).begins_at_start;
  FocusRequest here = request;
  if (at_start && !here.start) here.start = rig_.lens().position();
  Run run;
  run.limits = resolve_limits(here, rig_.lens().info());
  warn_of_inexact(rig_.lens(), asked_for(*run.limits), observer);
  const LossWatch losses(rig_.camera());
  run.repeat_scatter = repeated(rig_, at_start ? run.limits->start : run.limits->from, observer);
  observer.began(run, 0);
  conclude(
      run,
      search_focus(objective_of(rig_, run, observer), *run.limits, rig_.spec(), run.repeat_scatter),
      losses, observer);
  return run;
}

Run Session::track(const Run& before, Observer& observer) {
  // An observer may keep its runs, `before` among them, where began() moves them.
  const Focus last = before.focus.value();
  Run run;
  run.limits = before.limits.value();
  run.repeat_scatter = before.repeat_scatter;
  run.tracks = true;
  const LossWatch losses(rig_.camera());
  observer.began(run, 0);
  conclude(run,
           track_focus(objective_of(rig_, run, observer), *run.limits, rig_.spec(),
                       run.repeat_scatter, last),
           losses, observer);
  return run;
}

Run Session::sweep(const Sweep& sweep, Observer& observer) {
  const LensInfo lens = rig_.lens().info();
  const FocusLimits limits = resolve_limits(FocusRequest::within(sweep.from, sweep.to), lens);
  if (sweep.step && *sweep.step > 0 && *sweep.step < lens.resolution)
    observer.warned(StepTooFine{*sweep.step, lens.resolution, lens.unit});
  return visit(sweep.step ? sweep_positions(lens, limits.from, limits.to, *sweep.step)
                          : sweep_positions(lens, limits.from, limits.to),
               observer);
}

Run Session::visit(const std::vector<double>& positions, Observer& observer) {
  warn_of_inexact(rig_.lens(), positions, observer);
  const LossWatch losses(rig_.camera());
  Run run;
  observer.began(run, positions.size());
  for (const double position : positions)
    evaluate(rig_, rig_.lens().nearest(position), run, observer);
  if (!positions.empty()) tell_doubts(run, best_of(run.evaluations()).position, losses, observer);
  return run;
}

}  // namespace fathom
