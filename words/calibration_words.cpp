// SPDX-License-Identifier: Apache-2.0
#include "words/calibration_words.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"
#include "engine/window.hpp"

namespace fathom {
namespace {

using Doubts = std::vector<CalibrationDoubt>;

void compare(Doubts& doubts, const char* what, const std::string& then, const std::string& now,
             const std::string& advice) {
  if (then.empty() || now.empty() || then == now) return;
  doubts.push_back(
      {"calibration-differs",
       fmt::format("the calibration was made with {} {}, this is {}; distances may be off, by more "
                   "than sigma tells: {}",
                   what, then, now, advice)});
}

void compare_windows(Doubts& doubts, const Window& made, const Window& now, const Terms& terms) {
  if (made.n <= 0) return;
  if (made.x == CalibrationConditions::kUnknown) {
    return compare(doubts, "a window of side", std::to_string(made.n), std::to_string(now.n),
                   "use that side, or calibrate again");
  }
  compare(doubts, "window", to_string(made), to_string(now),
          fmt::format("use {} {}, or calibrate again", terms.window, to_string(made)));
}

}  // namespace

void require_unit(const Calibration& calibration, const std::string& unit) {
  const CalibrationConditions& made = calibration.conditions();
  if (!made.has_other_unit(unit)) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("the calibration has positions in {}, this lens counts {}; calibrate "
                          "this rig",
                          made.unit, unit));
}

std::vector<CalibrationDoubt> doubts_of(const Calibration& calibration,
                                        const CalibrationConditions& now, const Terms& terms) {
  Doubts doubts;
  if (calibration.freedom() < 1) {
    doubts.push_back({"calibration-bare",
                      "the calibration has no more points than parameters: sigma says nothing of "
                      "its error"});
  }
  if (calibration.r_squared() < kPoorRSquared) {
    doubts.push_back({"calibration-poor",
                      fmt::format("the calibration fits poorly, R^2 = {:.3f}; calibrate again",
                                  calibration.r_squared())});
  }
  const CalibrationConditions& made = calibration.conditions();
  compare(doubts, "rig", made.rig, now.rig, "calibrate this rig");
  compare(doubts, "metric", made.metric, now.metric,
          fmt::format("use {}, or calibrate again", terms.metric(made.metric)));
  compare_windows(doubts, made.window, now.window, terms);
  return doubts;
}

std::vector<CalibrationDoubt> doubts_of(const Calibration& calibration, const Likeness& likeness,
                                        double position) {
  constexpr double kWorthSaying = 0.05;
  Doubts doubts;
  const bool is_another = likeness.other_object > kWorthSaying;
  if (!likeness.apart) {
    doubts.push_back({"object-unknown",
                      "the object cannot be compared with the one that was calibrated, for the "
                      "spectrum of either in focus is not known: sigma holds for that object, and "
                      "not for another"});
  } else if (is_another) {
    doubts.push_back(
        {"other-object",
         fmt::format("the object is another than the one that was calibrated (their spectra are "
                     "{:.2f} apart): the depth that it focuses at may not be where you measure "
                     "to; calibrate on it",
                     *likeness.apart)});
  }
  if (is_another || likeness.other_metric || likeness.other_window) {
    doubts.push_back(
        {"sigma-widened", fmt::format("sigma holds {:.1f} mm for what differs from the calibration",
                                      strange_mm(calibration, likeness, position))});
  }
  return doubts;
}

double strange_mm(const Calibration& calibration, const Likeness& likeness, double position) {
  return std::abs(calibration.slope_mm(position)) * likeness.sigma;
}

}  // namespace fathom
