// SPDX-License-Identifier: Apache-2.0
// Calibrating and ranging on the simulated rig, with what a run keeps of its object.
#include "session/ranging.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/range.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"

namespace fathom {
namespace {

Rig rig_of(const std::string& text) {
  RigOptions options;
  options.rig = text;
  options.metric = "fft";
  options.backend = "cpu";
  return Rig(options);
}

RunFile calibrated_on(const std::string& text) {
  Rig rig = rig_of(text);
  RunKeeper keeper(setup_of(rig));
  keeper.file.setup.verb = "calibrate";
  for (const double distance : {1400.0, 1650.0, 1900.0, 2150.0, 2400.0, 2600.0}) {
    rig.stage()->place_at(distance);
    keeper.target_at(distance);
    Session(rig).focus({}, keeper);
  }
  keeper.file.calibration =
      Calibration::fit(CalibrationModel::inverse, calibration_points(keeper.file.runs),
                       conditions_of(keeper.file.setup));
  return keeper.file;
}

RunFile ranged_by(const RunFile& calibrated, const std::string& text) {
  Rig rig = rig_of(text);
  RunKeeper keeper(setup_of(rig));
  keeper.file.setup.verb = "range";
  keeper.file.calibration = calibrated.calibration;
  Session(rig).focus({}, keeper);
  keeper.file.distance = range_of(keeper.file, keeper.file.runs).distance;
  return keeper.file;
}

double error_in_sigmas(const Distance& distance, double truth_mm) {
  return std::abs(distance.mm - truth_mm) / distance.sigma_mm;
}

TEST(Ranging, KnowsAnotherObjectThanTheCalibrated) {
  const RunFile calibrated = calibrated_on("sim");
  EXPECT_TRUE(same_answer(calibrated, rerun(calibrated, "calibrated")));

  const RunFile chart = ranged_by(calibrated, "sim:distance=1700,seed=7");
  EXPECT_LT(error_in_sigmas(*chart.distance, 1700), 4);
  EXPECT_LT(chart.distance->sigma_mm, 1);
  EXPECT_EQ(range_of(chart, chart.runs).likeness.other_object, 0);

  // The needles stand some 6 mm before the stem that the tape measures to.
  const RunFile seedling = ranged_by(calibrated, "sim:target=seedling,distance=1700,seed=7");
  const Ranged ranged = range_of(seedling, seedling.runs);
  EXPECT_GT(ranged.likeness.other_object, 0.2);
  EXPECT_GT(std::abs(ranged.distance.mm - 1700), 3);
  EXPECT_LT(error_in_sigmas(ranged.distance, 1700), 3);
  const Distance blind =
      range_from_peaks(*seedling.calibration, focused_peaks(seedling.runs), 1, false);
  EXPECT_GT(error_in_sigmas(blind, 1700), 4) << "what the curve alone would say";

  const RunFile read = RunFile::parse(seedling.json(), "seedling");
  EXPECT_EQ(read.runs[0].spectrum, seedling.runs[0].spectrum);
  EXPECT_TRUE(same_answer(read, rerun(read, "seedling")));
}

TEST(Ranging, FollowsATargetThatMoves) {
  Rig rig = rig_of("sim:distance=1700,speed=4");
  RunKeeper keeper(setup_of(rig));
  Session session(rig);
  session.focus(FocusRequest::within(500, 1050), keeper);
  int told = 0;
  for (int i = 0; i < 5; ++i) {
    session.track(keeper.file.runs.back(), keeper);
    const Focus& focus = *keeper.file.runs.back().focus;
    if (focus.result() != FocusResult::focused) continue;
    const double truth = 1200 * 1084 / (rig.stage()->distance_mm() - 135);
    EXPECT_LT(std::abs(focus.position() - truth), 4 * focus.peak.sigma) << i;
    ++told;
  }
  EXPECT_GE(told, 3);
  EXPECT_TRUE(same_answer(keeper.file, rerun(keeper.file, "followed")));
}

}  // namespace
}  // namespace fathom
