// SPDX-License-Identifier: Apache-2.0
#include "session/run_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

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
  const Objective objective{[&](double p) {
                              const double x = (p - peak_of(distance_mm)) / 25;
                              const double score = 0.16 + 0.84 / (1 + x * x);
                              run.measurements.push_back({.position = p,
                                                          .score = score,
                                                          .brightness_share = 0,
                                                          .started_ns = 1,
                                                          .stopped_ns = 4,
                                                          .settled_ns = 5,
                                                          .exposure = {6, 7},
                                                          .compute_ns = 800,
                                                          .picture = {},
                                                          .note = p == 0 ? "first" : ""});
                              return score;
                            },
                            [](double p) { return std::round(p); }};
  run.focus = search_focus(objective, *run.limits, metric, run.repeat_scatter);
  return run;
}

RunFile file_of(const std::string& verb) {
  RunFile file;
  file.setup = {.verb = verb,
                .command = "fathom " + verb,
                .created = "2026-01-01T00:00:00Z",
                .rig = "sim",
                .camera = "test camera",
                .lens = lens_info(),
                .metric = MetricSpec::parse("walsh-sequency:64"),
                .window = Window{96, 88, 64},
                .backend = "reference",
                .backend_reason = "as asked",
                .average = 3};
  return file;
}

RunFile calibration_file() {
  RunFile file = file_of("calibrate");
  std::vector<CalibrationPoint> points;
  for (const double distance : {1400.0, 1700.0, 2000.0, 2300.0, 2600.0}) {
    file.runs.push_back(focused_run(distance, file.setup.metric));
    points.push_back({file.runs.back().focus->position(), distance});
  }
  file.calibration =
      Calibration::fit(CalibrationModel::inverse, points, {"rig", "m", {96, 88, 64}, "steps"});
  return file;
}

RunFile range_file() {
  RunFile file = file_of("range");
  file.calibration = calibration_file().calibration;
  file.runs.push_back(focused_run(1873, file.setup.metric));
  file.runs.back().target_mm.reset();
  file.distance =
      range_from_peaks(*file.calibration, std::vector<Peak>{file.runs[0].focus->peak}, 1, false);
  return file;
}

/// Of `range --all`: a surface that a calibration covers, and one that it does not.
RunFile surfaces_file() {
  RunFile file = file_of("range");
  file.calibration = calibration_file().calibration;
  KeptSurface near{.position = file.calibration->position_for(1700),
                   .sigma = 1,
                   .relief = 30,
                   .x = 3,
                   .y = 4,
                   .width_px = 100,
                   .height_px = 90,
                   .area = 0.2,
                   .texture = 0.4,
                   .window = Window{10, 20, 64}};
  KeptSurface far = near;
  far.position -= 10000;
  far.window.reset();
  near.distance = distance_of(*file.calibration, near, false);
  file.surfaces = {near, far};
  return file;
}

TEST(RunFile, KeepsSurfacesWhoseDistancesFollowAgain) {
  const RunFile file = surfaces_file();
  const RunFile back = RunFile::parse(file.json(), "run.json");
  EXPECT_EQ(back.json(), file.json());
  EXPECT_EQ(back.surfaces->at(0).window, (Window{10, 20, 64}));
  EXPECT_FALSE(back.surfaces->at(1).distance);
  EXPECT_TRUE(same_answer(file, rerun(back, "run.json")));
  // Any place of it may be meant.
  const Distance& near = *file.surfaces->at(0).distance;
  EXPECT_GT(near.sigma_mm,
            25 * std::abs(file.calibration->slope_mm(file.surfaces->at(0).position)));
  RunFile none = file;
  none.surfaces->clear();
  EXPECT_TRUE(RunFile::parse(none.json(), "run.json").surfaces.has_value());
  EXPECT_FALSE(same_answer(file, none));
  for (const auto change :
       {+[](KeptSurface& s) { s.position += 0.01; }, +[](KeptSurface& s) { s.relief *= 1.01; },
        +[](KeptSurface& s) { s.distance->mm += 0.01; },
        +[](KeptSurface& s) { s.distance.reset(); }}) {
    RunFile changed = file;
    change(changed.surfaces->front());
    EXPECT_FALSE(same_answer(changed, rerun(changed, "run.json")));
  }
}

TEST(RunFile, RoundTripsThroughItsFile) {
  for (const RunFile& file : {calibration_file(), range_file()}) {
    const RunFile again = RunFile::parse(file.json(), "run.json");
    EXPECT_EQ(again.json(), file.json());
    EXPECT_TRUE(same_answer(file, again));
    EXPECT_EQ(again.setup.metric, file.setup.metric);
    EXPECT_EQ(again.setup.window, file.setup.window);
    EXPECT_EQ(again.runs[0].limits, file.runs[0].limits);
    EXPECT_EQ(again.runs[0].measurements[0].exposure.start_ns, 6);
    EXPECT_EQ(again.runs[0].measurements[0].note, "first");
  }
}

TEST(RunFile, KeepsTheOpticsOfALensThatHasThem) {
  RunFile file = range_file();
  EXPECT_FALSE(RunFile::parse(file.json(), "run.json").setup.lens.optics);
  file.setup.lens.optics = Optics{135, 4, 0.04};
  const std::string text = file.json();
  EXPECT_EQ(RunFile::parse(text, "run.json").setup.lens.optics, (Optics{135, 4, 0.04}));
  for (const auto& [whole, broken] : std::vector<std::pair<std::string, std::string>>{
           {"\"f_number\": 4.0", "\"f_number\": 0"}, {"\"focal_mm\"", "\"focal\""}}) {
    std::string damaged = text;
    ASSERT_NE(damaged.find(whole), std::string::npos);
    damaged.replace(damaged.find(whole), whole.size(), broken);
    EXPECT_THROW(RunFile::parse(damaged, "run.json"), Error) << broken;
  }
}

TEST(RunFile, IsComputedAgainToTheSameAnswer) {
  for (const RunFile& file : {calibration_file(), range_file()}) {
    const RunFile again = rerun(RunFile::parse(file.json(), "run.json"), "run.json");
    EXPECT_TRUE(same_answer(file, again)) << file.setup.verb;
  }
}

TEST(RunFile, RerunComputesTheAnswerAndDoesNotCopyIt) {
  RunFile file = range_file();
  file.distance->mm *= 1 + 1e-8;
  EXPECT_FALSE(same_answer(file, rerun(file, "run.json")));
  file = range_file();
  file.runs[0].focus->peak.position += 1;
  EXPECT_FALSE(same_answer(file, rerun(file, "run.json")));
  file = calibration_file();
  file.runs[0].focus->verdict.result = FocusResult::no_focus;
  EXPECT_FALSE(same_answer(file, rerun(file, "run.json")));
}

/// Everything that a focus holds is compared.
TEST(RunFile, RerunNoticesAnyChangeOfAFocus) {
  const std::vector<std::function<void(Focus&)>> changes = {
      [](Focus& f) { f.floor *= 1.0001; },
      [](Focus& f) {
        f.background.push_back({1, 2, 3});
      },
      [](Focus& f) { f.evaluations[1].score *= 1.0001; },
      [](Focus& f) { f.evaluations.pop_back(); },
      [](Focus& f) { f.lobes[0].position += 0.001; },
      [](Focus& f) { f.lobes.push_back(f.lobes[0]); },
      [](Focus& f) { f.peak.sigma *= 1.001; },
      [](Focus& f) { f.peak.shape = PeakShape::none; },
      [](Focus& f) { f.verdict.confidence *= 0.999; },
      [](Focus& f) { f.verdict.reason.why = Why::unsure; },
      [](Focus& f) { f.verdict.rise.needed *= 1.001; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    RunFile file = range_file();
    changes[i](*file.runs[0].focus);
    EXPECT_FALSE(same_answer(file, rerun(file, "run.json"))) << i;
    file = RunFile::parse(file.json(), "run.json");
    EXPECT_FALSE(same_answer(file, rerun(file, "run.json"))) << i << ", from its file";
  }
}

TEST(RunFile, KeepsAFocusComplete) {
  RunFile file = range_file();
  Focus& focus = *file.runs[0].focus;
  focus.background = {{3, 17.5, 0.25}, {1, 900, 0.125}};
  const Focus again = *RunFile::parse(file.json(), "run.json").runs[0].focus;
  EXPECT_EQ(again.background, focus.background);
  EXPECT_EQ(again.evaluations, focus.evaluations);
  EXPECT_EQ(again.floor, focus.floor);
  ASSERT_EQ(again.lobes.size(), focus.lobes.size());
  EXPECT_EQ(again.lobes[0].half_width, focus.lobes[0].half_width);
  EXPECT_EQ(again.verdict.reason, focus.verdict.reason);
}

TEST(RunFile, RerunNoticesChangedScores) {
  RunFile file = range_file();
  for (Measurement& m : file.runs[0].measurements) m.score = 1 / m.score;
  EXPECT_THROW(rerun(file, "run.json"), Error);
  file = range_file();
  file.runs[0].measurements.pop_back();
  EXPECT_THROW(rerun(file, "run.json"), Error);
}

TEST(RunFile, AnUnfinishedRunKeepsItsMeasurements) {
  RunFile file = range_file();
  file.distance.reset();
  file.runs[0].focus.reset();
  file.runs[0].measurements.resize(4);
  file.error = "the camera was unplugged";
  const RunFile again = RunFile::parse(file.json(), "run.json");
  EXPECT_EQ(again.runs[0].measurements.size(), 4u);
  EXPECT_EQ(again.error, "the camera was unplugged");
  EXPECT_TRUE(same_answer(again, rerun(again, "run.json")));
}

TEST(RunFile, RefusesOtherFiles) {
  for (const char* text :
       {"", "{", "[]", R"({"format":"fathom-calibration","version":1})",
        R"({"format":"fathom-record","version":1})", R"({"format":"fathom-run","version":2})",
        R"({"format":"fathom-record","version":2,"setup":{}})",
        R"({"format":"fathom-run","version":3,"setup":{}})"}) {
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
