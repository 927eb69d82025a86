// SPDX-License-Identifier: Apache-2.0
#include "session/run_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "focus/track.hpp"
#include "session/ranging.hpp"

namespace fathom {
namespace {

/// Tells again of the pictures that were taken on a way, and of the one where the lens was halted
/// short of its end.
void pass_again(const Run& run, std::size_t& next, const PictureOnTheWay& goes_on) {
  while (next < run.measurements.size()) {
    const Measurement& m = run.measurements[next];
    if (!m.on_the_way && !m.set_out_from) return;  // the lens had arrived
    ++next;
    if (!goes_on(m.position, m.sample())) return;
  }
}

/// An objective that answers from what was measured, and only in the order in which it was.
Objective measured_objective(const Run& run, const LensInfo& lens, std::size_t& next) {
  const auto score = [&run, &next](double position) -> Sample {
    if (next >= run.measurements.size() || run.measurements[next].position != position) {
      throw Error(
          ErrorCode::bad_data,
          fmt::format(
              "evaluation {} should be at position {:g}, which the file does not have there",
              next + 1, position));
    }
    return run.measurements[next++].sample();
  };
  return {score, [&lens](double wanted) { return nearest_position(lens, wanted); },
          [&run, &next](double, double, const PictureOnTheWay& goes_on) {
            pass_again(run, next, goes_on);
          }};
}

/// before: the run before it, computed again, for a run that tracks.
Focus focus_again(const Run& run, const RunSetup& setup, const Run* before, std::size_t& next) {
  const Objective objective = measured_objective(run, setup.lens, next);
  if (!run.tracks || before == nullptr)
    return search_focus(objective, *run.limits, setup.metric, run.repeat_scatter);
  if (!run.by_time) {
    return track_still_focus(objective, *run.limits, setup.metric, run.repeat_scatter,
                             *before->focus);
  }
  const auto time_s = [&run, &next] { return middle_s(run.measurements.at(next - 1)); };
  return track_focus({objective, time_s}, *run.limits, setup.metric, run.repeat_scatter,
                     *before->focus, before->sightings());
}

Focus search_again(const Run& run, const RunSetup& setup, const Run* before) {
  std::size_t next = 0;
  Focus focus = focus_again(run, setup, before, next);
  if (next != run.measurements.size()) {
    throw Error(ErrorCode::bad_data, fmt::format("the file has {} evaluations, but the search ends "
                                                 "after {}",
                                                 run.measurements.size(), next));
  }
  doubt_for_losses(focus, run.lost_part);
  doubt_for_resemblance(focus, run.resemblance);
  doubt_for_first_look(focus, run.first_look, run.start_position.value_or(0));
  return focus;
}

/// The same but for the last bits, in which processors and compilers may differ.
bool alike(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max({std::abs(a), std::abs(b), 1e-300});
}

/// The same uncertainty: what follows from the small differences between a shape and its points, in
/// which last bits count for more. scale: of the position that it belongs to.
bool as_sure(double a, double b, double scale) {
  return std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b)) + 1e-9 * std::abs(scale);
}

bool same_peak(const Peak& a, const Peak& b) {
  return a.shape == b.shape && a.points == b.points && a.parameters == b.parameters &&
         alike(a.position, b.position) && alike(a.score, b.score) &&
         as_sure(a.half_width, b.half_width, a.position) &&
         as_sure(a.sigma, b.sigma, a.half_width) && as_sure(a.r_squared, b.r_squared, 1);
}

bool same_verdict(const Verdict& a, const Verdict& b) {
  return a.result == b.result && as_sure(a.confidence, b.confidence, 1) &&
         alike(a.rise.contrast, b.rise.contrast) && alike(a.rise.rise, b.rise.rise) &&
         alike(a.rise.needed, b.rise.needed);
}

/// What only advice is made of, as that there is no larger window, follows from the limits.
bool same_reason(const Reason& a, const Reason& b) {
  return a.why == b.why && alike(a.position, b.position) && as_sure(a.r_squared, b.r_squared, 1) &&
         as_sure(a.confidence, b.confidence, 1) && alike(a.second_position, b.second_position) &&
         as_sure(a.second_part, b.second_part, 1) && alike(a.contrast, b.contrast) &&
         a.is_live == b.is_live && a.at_lens_end == b.at_lens_end && a.transform == b.transform &&
         a.evaluations == b.evaluations && a.dead == b.dead;
}

/// The same curve: loops, positions and scores. What else the pictures told stands in the
/// measurements alone.
bool same_evaluations(const std::vector<Evaluation>& a, const std::vector<Evaluation>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Evaluation& one, const Evaluation& other) {
                      return one.loop == other.loop && one.position == other.position &&
                             alike(one.score, other.score);
                    });
}

/// Curves were judged by other rules before version 4: that their answers agree is all that can be
/// asked.
bool agrees_with_old(const Focus& old, const Focus& now) {
  const bool same_place =
      std::abs(old.position() - now.position()) <= std::max(old.peak.sigma, now.peak.sigma);
  return old.result() == now.result() && same_place &&
         same_evaluations(old.evaluations, now.evaluations);
}

/// is_complete: whether both kept what files kept from version 4 on.
bool same_focus(const std::optional<Focus>& a, const std::optional<Focus>& b, bool is_complete) {
  if (!a || !b) return a.has_value() == b.has_value();
  if (!is_complete) return agrees_with_old(*a, *b);
  const bool same_spectra =
      a->spectral_end == b->spectral_end && a->spectral.has_value() == b->spectral.has_value() &&
      (!a->spectral || (a->spectral->pictures == b->spectral->pictures &&
                        as_sure(a->spectral->position, b->spectral->position, 1)));
  const bool same_rest = same_spectra && same_evaluations(a->background, b->background) &&
                         same_evaluations(a->second_looks, b->second_looks) &&
                         alike(a->floor, b->floor) &&
                         same_reason(a->verdict.reason, b->verdict.reason);
  return same_rest && same_verdict(a->verdict, b->verdict) && same_peak(a->peak, b->peak) &&
         std::equal(a->lobes.begin(), a->lobes.end(), b->lobes.begin(), b->lobes.end(),
                    same_peak) &&
         same_evaluations(a->evaluations, b->evaluations);
}

bool same_points(const Calibration& a, const Calibration& b) {
  return std::equal(a.points().begin(), a.points().end(), b.points().begin(), b.points().end(),
                    [](const CalibrationPoint& one, const CalibrationPoint& other) {
                      return alike(one.position, other.position) &&
                             alike(one.distance_mm, other.distance_mm);
                    });
}

bool same_curve(const Calibration& a, const Calibration& b) {
  const auto one = a.parameters(), other = b.parameters();
  if (a.model() != b.model() || one.size() != other.size() || !same_points(a, b)) return false;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (!alike(one[i].value, other[i].value)) return false;
  }
  return true;
}

RunFile computed_again(const RunFile& file) {
  RunFile again = file;
  const Run* before = nullptr;
  for (Run& run : again.runs) {
    if (!run.limits || !run.focus) continue;
    run.focus = search_again(run, file.setup, before);
    before = &run;
  }
  if (file.setup.verb == "calibrate" && file.calibration) {
    again.calibration = Calibration::fit(file.calibration->model(), calibration_points(again.runs),
                                         file.calibration->conditions());
  }
  if (file.setup.verb == "range" && file.distance && file.calibration) {
    again.distance = range_of(again, again.runs).distance;
  }
  if (file.surfaces && file.calibration) {
    for (KeptSurface& surface : *again.surfaces)
      surface.distance = distance_of(*file.calibration, surface, file.extrapolate);
  }
  return again;
}

bool same_distance(const std::optional<Distance>& a, const std::optional<Distance>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return alike(a->mm, b->mm) && alike(a->sigma_mm, b->sigma_mm);
}

bool same_surfaces(const std::optional<std::vector<KeptSurface>>& a,
                   const std::optional<std::vector<KeptSurface>>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return std::equal(a->begin(), a->end(), b->begin(), b->end(),
                    [](const KeptSurface& one, const KeptSurface& other) {
                      return alike(one.position, other.position) &&
                             same_distance(one.distance, other.distance);
                    });
}

}  // namespace

RunFile rerun(const RunFile& file, std::string_view name) {
  try {
    return computed_again(file);
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} cannot be computed again: {}", name, error.what()));
  }
}

bool same_answer(const RunFile& a, const RunFile& b) {
  if (a.runs.size() != b.runs.size() || a.calibration.has_value() != b.calibration.has_value())
    return false;
  if (!same_distance(a.distance, b.distance) || !same_surfaces(a.surfaces, b.surfaces))
    return false;
  const bool is_complete = std::min(a.version, b.version) >= RunFile::kVersion;
  for (std::size_t i = 0; i < a.runs.size(); ++i) {
    if (!same_focus(a.runs[i].focus, b.runs[i].focus, is_complete)) return false;
  }
  return !a.calibration || same_curve(*a.calibration, *b.calibration);
}

}  // namespace fathom
