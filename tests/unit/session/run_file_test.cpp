// SPDX-License-Identifier: Apache-2.0
#include "session/run_file.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/range.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

LensInfo lens_info() { return {"test lens", "steps", 0, 1200, 1, 100, {}}; }

double peak_of(double distance_mm) { return 1.3e6 / (distance_mm - 135); }

Run focused_run(double distance_mm, const MetricSpec& metric) {
  Run run;
  run.target_mm = distance_mm;
  run.limits = resolve_limits({}, lens_info());
  run.repeat_scatter = 0.004;
  const Objective objective{
      [&](double p) {
        const double x = (p - peak_of(distance_mm)) / 25;
        const double score = 0.16 + 0.84 / (1 + x * x);
        run.measurements.push_back({p, score, 5, {6, 7}, p == 0 ? "first" : "", 1, 4, 800});
        return score;
      },
      [](double p) { return std::round(p); }};
  run.focus = search_focus(objective, *run.limits, metric, run.repeat_scatter);
  return run;
}

RunFile record_of(const std::string& verb) {
  RunFile record;
  record.setup = {verb,
                  "fathom " + verb,
                  "2026-01-01T00:00:00Z",
                  "sim",
                  "test camera",
                  lens_info(),
                  MetricSpec::parse("walsh-sequency:64"),
                  Window{96, 88, 64},
                  "reference",
                  "as asked",
                  3};
  return record;
}

RunFile calibration_record() {
  RunFile record = record_of("calibrate");
  std::vector<CalibrationPoint> points;
  for (const double distance : {1400.0, 1700.0, 2000.0, 2300.0, 2600.0}) {
    record.runs.push_back(focused_run(distance, record.setup.metric));
    points.push_back({record.runs.back().focus->position(), distance});
  }
  record.calibration =
      Calibration::fit(CalibrationModel::inverse, points, {"rig", "m", {96, 88, 64}, "steps"});
  return record;
}

RunFile range_record() {
  RunFile record = record_of("range");
  record.calibration = calibration_record().calibration;
  record.runs.push_back(focused_run(1873, record.setup.metric));
  record.runs.back().target_mm.reset();
  record.distance = range_from_peaks(*record.calibration,
                                     std::vector<Peak>{record.runs[0].focus->peak}, 1, false);
  return record;
}

TEST(RunFile, RoundTripsThroughItsFile) {
  for (const RunFile& record : {calibration_record(), range_record()}) {
    const RunFile again = RunFile::parse(record.json(), "run.json");
    EXPECT_EQ(again.json(), record.json());
    EXPECT_TRUE(same_answer(record, again));
    EXPECT_EQ(again.setup.metric, record.setup.metric);
    EXPECT_EQ(again.setup.window, record.setup.window);
    EXPECT_EQ(again.runs[0].limits, record.runs[0].limits);
    EXPECT_EQ(again.runs[0].measurements[0].exposure.start_ns, 6);
    EXPECT_EQ(again.runs[0].measurements[0].note, "first");
  }
}

TEST(RunFile, KeepsTheOpticsOfALensThatHasThem) {
  RunFile record = range_record();
  EXPECT_FALSE(RunFile::parse(record.json(), "run.json").setup.lens.optics);
  record.setup.lens.optics = Optics{135, 4, 0.04};
  const std::string text = record.json();
  EXPECT_EQ(RunFile::parse(text, "run.json").setup.lens.optics, (Optics{135, 4, 0.04}));
  for (const auto& [whole, broken] : std::vector<std::pair<std::string, std::string>>{
           {"\"f_number\": 4.0", "\"f_number\": 0"}, {"\"focal_mm\"", "\"focal\""}}) {
    std::string damaged = text;
    ASSERT_NE(damaged.find(whole), std::string::npos);
    damaged.replace(damaged.find(whole), whole.size(), broken);
    EXPECT_THROW(RunFile::parse(damaged, "run.json"), Error) << broken;
  }
}

TEST(RunFile, ReplaysToTheSameAnswer) {
  for (const RunFile& record : {calibration_record(), range_record()}) {
    const RunFile again = replay(RunFile::parse(record.json(), "run.json"), "run.json");
    EXPECT_TRUE(same_answer(record, again)) << record.setup.verb;
  }
}

TEST(RunFile, ReplayComputesTheAnswerAndDoesNotCopyIt) {
  RunFile record = range_record();
  record.distance->mm *= 1 + 1e-8;
  EXPECT_FALSE(same_answer(record, replay(record, "run.json")));
  record = range_record();
  record.runs[0].focus->peak.position += 1;
  EXPECT_FALSE(same_answer(record, replay(record, "run.json")));
  record = calibration_record();
  record.runs[0].focus->verdict.result = FocusResult::no_focus;
  EXPECT_FALSE(same_answer(record, replay(record, "run.json")));
}

TEST(RunFile, ReplayNoticesChangedScores) {
  RunFile record = range_record();
  for (Measurement& m : record.runs[0].measurements) m.score = 1 / m.score;
  EXPECT_THROW(replay(record, "run.json"), Error);
  record = range_record();
  record.runs[0].measurements.pop_back();
  EXPECT_THROW(replay(record, "run.json"), Error);
}

TEST(RunFile, AnUnfinishedRunKeepsItsMeasurements) {
  RunFile record = range_record();
  record.distance.reset();
  record.runs[0].focus.reset();
  record.runs[0].measurements.resize(4);
  record.error = "the camera was unplugged";
  const RunFile again = RunFile::parse(record.json(), "run.json");
  EXPECT_EQ(again.runs[0].measurements.size(), 4u);
  EXPECT_EQ(again.error, "the camera was unplugged");
  EXPECT_TRUE(same_answer(again, replay(again, "run.json")));
}

TEST(RunFile, RefusesOtherFiles) {
  for (const char* text : {"", "{", "[]", R"({"format":"fathom-calibration","version":1})",
                           R"({"format":"fathom-record","version":1})",
                           R"({"format":"fathom-record","version":2,"setup":{}})"}) {
    try {
      RunFile::parse(text, "run.json");
      ADD_FAILURE() << "took " << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_data);
      EXPECT_NE(std::string(error.what()).find("run.json"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace fathom
