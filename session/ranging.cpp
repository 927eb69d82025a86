// SPDX-License-Identifier: Apache-2.0
#include "session/ranging.hpp"

#include <cmath>
#include <vector>

#include "calibration/range.hpp"
#include "focus/focus.hpp"

namespace fathom {
namespace {

bool has_focused(const Run& run) {
  return run.focus && run.focus->result() == FocusResult::focused;
}

/// The peak with a width, also where the answer is an evaluated position, which has none.
Peak wide_peak(const Focus& focus) {
  Peak peak = focus.peak;
  if (peak.half_width == 0 && !focus.lobes.empty()) peak.half_width = focus.lobes[0].half_width;
  return peak;
}

/// Whether the sharpest picture is in focus. Of a few frames it may not be, and blur is no other object.
bool has_sharp_picture(const Run& run) {
  if (!run.limits || run.limits->most_pictures == 0 || !run.limits->blur) return true;
  constexpr double kSharpPx = 1;
  const double sharp = run.limits->blur->units(kSharpPx);
  return std::abs(best_of(run.focus->evaluations).position - run.focus->position()) <= sharp;
}

/// Runs of before there were spectra keep their answers, and so does a window too small for them.
Likeness least_likeness(const RunFile& file, std::span<const Run> runs) {
  const CalibrationConditions now = conditions_of(file.setup);
  Likeness least;
  for (const Run& run : runs) {
    if (!has_focused(run) || run.spectrum.empty()) continue;
    const std::vector<double> spectrum =
        has_sharp_picture(run) ? run.spectrum : std::vector<double>{};
    const Likeness one = likeness_of(*file.calibration, wide_peak(*run.focus), spectrum, now);
    if (!least.apart || one.sigma > least.sigma) least = one;
  }
  return least;
}

}  // namespace

std::vector<CalibrationPoint> calibration_points(std::span<const Run> runs) {
  std::vector<CalibrationPoint> points;
  for (const Run& run : runs) {
    if (!has_focused(run) || !run.target_mm) continue;
    points.push_back({run.focus->position(), *run.target_mm, run.focus->peak.sigma, run.spectrum});
  }
  return points;
}

std::vector<Peak> focused_peaks(std::span<const Run> runs) {
  std::vector<Peak> peaks;
  for (const Run& run : runs) {
    if (has_focused(run)) peaks.push_back(run.focus->peak);
  }
  return peaks;
}

CalibrationConditions conditions_of(const RunSetup& setup) {
  return {.rig = setup.camera + "; " + setup.lens.description,
          .metric = setup.metric.text(),
          .window = setup.window,
          .unit = setup.lens.unit};
}

Ranged range_of(const RunFile& file, std::span<const Run> runs) {
  Ranged ranged;
  ranged.likeness = least_likeness(file, runs);
  ranged.distance =
      range_from_peaks(*file.calibration, focused_peaks(runs), file.setup.lens.resolution,
                       file.extrapolate, ranged.likeness.sigma);
  return ranged;
}

}  // namespace fathom
