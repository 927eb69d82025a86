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
Objective recorded_objective(const Run& run, const LensInfo& lens, std::size_t& next) {
  const auto score = [&run, &next](double position) {
    if (next >= run.measurements.size() || run.measurements[next].position != position) {
      throw Error(
          ErrorCode::bad_data,
          fmt::format(
              "evaluation {} should be at position {:g}, which the record does not have there",
              next + 1, position));
    }
    return run.measurements[next++].score;
  };
  return {score, [&lens](double wanted) { return nearest_position(lens, wanted); }};
}

/// before: what the run before it came to, for a run that tracks.
Focus replay_search(const Run& run, const RunSetup& setup, const Focus* before) {
  std::size_t next = 0;
  const Objective objective = recorded_objective(run, setup.lens, next);
  Focus focus = run.tracks && before != nullptr
                    ? track_focus(objective, *run.limits, setup.metric, run.repeat_scatter, *before)
                    : search_focus(objective, *run.limits, setup.metric, run.repeat_scatter);
  if (next != run.measurements.size()) {
    throw Error(ErrorCode::bad_data,
                fmt::format("the record has {} evaluations, but the search ends "
                            "after {}",
                            run.measurements.size(), next));
  }
  return focus;
}

std::vector<CalibrationPoint> focused_points(const RunFile& record) {
  std::vector<CalibrationPoint> points;
  for (const Run& run : record.runs) {
    if (run.focus && run.focus->result() == FocusResult::focused && run.target_mm) {
      points.push_back({run.focus->position(), *run.target_mm});
    }
  }
  return points;
}

std::vector<Peak> focused_peaks(const RunFile& record) {
  std::vector<Peak> peaks;
  for (const Run& run : record.runs) {
    if (run.focus && run.focus->result() == FocusResult::focused) peaks.push_back(run.focus->peak);
  }
  return peaks;
}

/// The same but for the last bits, in which processors and compilers may differ.
bool alike(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max({std::abs(a), std::abs(b), 1e-300});
}

bool same_focus(const std::optional<Focus>& a, const std::optional<Focus>& b) {
  if (a.has_value() != b.has_value()) return false;
  return !a || (a->result() == b->result() && alike(a->position(), b->position()) &&
                alike(a->peak.score, b->peak.score) && a->evaluations == b->evaluations);
}

bool same_curve(const Calibration& a, const Calibration& b) {
  const auto one = a.parameters(), other = b.parameters();
  if (a.model() != b.model() || one.size() != other.size()) return false;
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (!alike(one[i].value, other[i].value)) return false;
  }
  return true;
}

}  // namespace

std::vector<Evaluation> Run::evaluations() const {
  std::vector<Evaluation> evaluations;
  for (const Measurement& m : measurements) {
    evaluations.push_back({static_cast<int>(evaluations.size()) + 1, m.position, m.score});
  }
  return evaluations;
}

namespace {

RunFile replayed(const RunFile& record) {
  RunFile again = record;
  const Focus* before = nullptr;
  for (Run& run : again.runs) {
    if (!run.limits || !run.focus) continue;
    run.focus = replay_search(run, record.setup, before);
    before = &*run.focus;
  }
  if (record.setup.verb == "calibrate" && record.calibration) {
    again.calibration = Calibration::fit(record.calibration->model(), focused_points(again),
                                         record.calibration->conditions());
  }
  if (record.setup.verb == "range" && record.distance && record.calibration) {
    again.distance = range_from_peaks(*record.calibration, focused_peaks(again),
                                      record.setup.lens.resolution, record.extrapolate);
  }
  return again;
}

}  // namespace

RunFile replay(const RunFile& record, std::string_view name) {
  try {
    return replayed(record);
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{} does not replay: {}", name, error.what()));
  }
}

bool same_answer(const RunFile& a, const RunFile& b) {
  if (a.runs.size() != b.runs.size() || a.calibration.has_value() != b.calibration.has_value() ||
      a.distance.has_value() != b.distance.has_value()) {
    return false;
  }
  for (std::size_t i = 0; i < a.runs.size(); ++i) {
    if (!same_focus(a.runs[i].focus, b.runs[i].focus)) return false;
  }
  if (a.calibration && !same_curve(*a.calibration, *b.calibration)) return false;
  return !a.distance || (alike(a.distance->mm, b.distance->mm) &&
                         alike(a.distance->sigma_mm, b.distance->sigma_mm));
}

}  // namespace fathom
