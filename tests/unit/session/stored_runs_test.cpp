// SPDX-License-Identifier: Apache-2.0
// Run files that earlier versions wrote: they are read for ever, compute again to their answers,
// and the same rig gives the same numbers.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/file.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"

namespace fathom {
namespace {

RunFile stored(const std::string& name) {
  return RunFile::parse(read_file(std::string(FATHOM_STORED_RUNS) + "/" + name, 1 << 20), name);
}

TEST(StoredRuns, OfVersion2AreComputedAgainToTheSameAnswer) {
  for (const char* const name : {"auto.json", "hill.json", "tracked.json"}) {
    const RunFile file = stored(name);
    EXPECT_EQ(file.version, 2);
    const RunFile again = rerun(file, name);
    EXPECT_TRUE(same_answer(file, again)) << name;
    for (const auto& run : again.runs) EXPECT_TRUE(run.focus && run.focus->floor > 0) << name;
  }
}

TEST(StoredRuns, KeepWhatVersion2Kept) {
  const RunFile file = stored("tracked.json");
  ASSERT_EQ(file.runs.size(), 2u);
  EXPECT_FALSE(file.runs[0].tracks);
  EXPECT_TRUE(file.runs[1].tracks);
  EXPECT_TRUE(file.calibration);
  const Focus& focus = *file.runs[0].focus;
  EXPECT_EQ(focus.result(), FocusResult::focused);
  EXPECT_EQ(focus.evaluations, file.runs[0].evaluations());
  EXPECT_GT(focus.lobes.at(0).half_width, 0);
  EXPECT_GT(file.runs[0].measurements.at(0).exposure.start_ns, 0);
}

/// Read once, it is written as today's.
TEST(StoredRuns, AreWrittenAsTheVersionOfToday) {
  const RunFile again = rerun(stored("tracked.json"), "tracked.json");
  const RunFile written = RunFile::parse(again.json(), "written");
  EXPECT_EQ(written.version, RunFile::kVersion);
  EXPECT_FALSE(written.runs[1].focus->background.empty());
  EXPECT_TRUE(same_answer(written, rerun(written, "written")));
}

void expect_same_scores(const Run& fresh, const Run& kept) {
  ASSERT_EQ(fresh.measurements.size(), kept.measurements.size());
  for (std::size_t i = 0; i < kept.measurements.size(); ++i) {
    EXPECT_EQ(fresh.measurements[i].position, kept.measurements[i].position) << i;
    EXPECT_NEAR(fresh.measurements[i].score / kept.measurements[i].score, 1, 1e-9) << i;
    EXPECT_EQ(fresh.measurements[i].exposure.end_ns, kept.measurements[i].exposure.end_ns) << i;
  }
}

/// Repeated frames, moves and exposures stand where they stood, so the noise is the same.
TEST(StoredRuns, ComeOutOfTheSameRigAgain) {
  for (const char* const name : {"auto.json", "hill.json"}) {
    const RunFile file = stored(name);
    RigOptions options;
    options.rig = file.setup.rig;
    options.backend = "cpu";
    Rig rig(options);
    Observer nobody;
    FocusRequest request;
    request.search = file.runs[0].limits->search;
    const auto fresh = Session(rig).focus(request, nobody);
    EXPECT_EQ(fresh.limits, file.runs[0].limits) << name;
    EXPECT_NEAR(fresh.repeat_scatter / file.runs[0].repeat_scatter, 1, 1e-9) << name;
    expect_same_scores(fresh, file.runs[0]);
  }
}

}  // namespace
}  // namespace fathom
