// SPDX-License-Identifier: Apache-2.0
#include "session/run_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/range.hpp"
#include "engine/error.hpp"
#include "focus/track.hpp"

namespace fathom {
namespace {

/// An objective that answers from what was measured, and only in the order in which it was.
Objective measured_objective(const Run& run, const LensInfo& lens, std::size_t& next) {
  const auto score = [&run, &next](double position) {
    if (next >= run.measurements.size() || run.measurements[next].position != position) {
      throw Error(
          ErrorCode::bad_data,
          fmt::format(
              "evaluation {} should be at position {:g}, which the file does not have there",
              next + 1, position));
    }
    return run.measurements[next++].score;
  };
  return {score, [&lens](double wanted) { return nearest_position(lens, wanted); }};
}

/// before: what the run before it came to, for a run that tracks.
Focus search_again(const Run& run, const RunSetup& setup, const Focus* before) {
  std::size_t next = 0;
  const Objective objective = measured_objective(run, setup.lens, next);
  Focus focus = run.tracks && before != nullptr
                    ? track_focus(objective, *run.limits, setup.metric, run.repeat_scatter, *before)
                    : search_focus(objective, *run.limits, setup.metric, run.repeat_scatter);
  if (next != run.measurements.size()) {
    throw Error(ErrorCode::bad_data, fmt::format("the file has {} evaluations, but the search ends "
                                                 "after {}",
                                                 run.measurements.size(), next));
  }
  return focus;
}

std::vector<CalibrationPoint> focused_points(const RunFile& file) {
  std::vector<CalibrationPoint> points;
  for (const Run& run : file.runs) {
    if (run.focus && run.focus->result() == FocusResult::focused && run.target_mm) {
      points.push_back({run.focus->position(), *run.target_mm});
    }
  }
  return points;
}

std::vector<Peak> focused_peaks(const RunFile& file) {
  std::vector<Peak> peaks;
  for (const Run& run : file.runs) {
    if (run.focus && run.focus->result() == FocusResult::focused) peaks.push_back(run.focus->peak);
  }
  return peaks;
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

/// is_complete: whether both kept what files kept from version 3 on.
bool same_focus(const std::optional<Focus>& a, const std::optional<Focus>& b, bool is_complete) {
  if (!a || !b) return a.has_value() == b.has_value();
  const bool same_rest = a->background == b->background && alike(a->floor, b->floor) &&
                         a->verdict.reason.why == b->verdict.reason.why;
  if (is_complete && !same_rest) return false;
  return same_verdict(a->verdict, b->verdict) && same_peak(a->peak, b->peak) &&
         std::equal(a->lobes.begin(), a->lobes.end(), b->lobes.begin(), b->lobes.end(),
                    same_peak) &&
         a->evaluations == b->evaluations;
}

bool same_curve(const Calibration& a, const Calibration& b) {
  const auto one = a.parameters(), other = b.parameters();
  if (a.model() != b.model() || one.size() != other.size()) return false;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (!alike(one[i].value, other[i].value)) return false;
  }
  return true;
}

RunFile computed_again(const RunFile& file) {
  RunFile again = file;
  const Focus* before = nullptr;
  for (Run& run : again.runs) {
    if (!run.limits || !run.focus) continue;
    run.focus = search_again(run, file.setup, before);
    before = &*run.focus;
  }
  if (file.setup.verb == "calibrate" && file.calibration) {
    again.calibration = Calibration::fit(file.calibration->model(), focused_points(again),
                                         file.calibration->conditions());
  }
  if (file.setup.verb == "range" && file.distance && file.calibration) {
    again.distance = range_from_peaks(*file.calibration, focused_peaks(again),
                                      file.setup.lens.resolution, file.extrapolate);
  }
  return again;
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
  if (a.runs.size() != b.runs.size() || a.calibration.has_value() != b.calibration.has_value() ||
      a.distance.has_value() != b.distance.has_value()) {
    return false;
  }
  const bool is_complete = std::min(a.version, b.version) >= RunFile::kVersion;
  for (std::size_t i = 0; i < a.runs.size(); ++i) {
    if (!same_focus(a.runs[i].focus, b.runs[i].focus, is_complete)) return false;
  }
  if (a.calibration && !same_curve(*a.calibration, *b.calibration)) return false;
  return !a.distance || (alike(a.distance->mm, b.distance->mm) &&
                         alike(a.distance->sigma_mm, b.distance->sigma_mm));
}

}  // namespace fathom
