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
  // Later versions look again when the search is over.
  ASSERT_EQ(fresh.measurements.size() - fresh.focus->second_looks.size(), kept.measurements.size());
  for (std::size_t i = 0; i < kept.measurements.size(); ++i) {
    EXPECT_EQ(fresh.measurements[i].position, kept.measurements[i].position) << i;
    EXPECT_NEAR(fresh.measurements[i].score / kept.measurements[i].score, 1, 1e-9) << i;
    EXPECT_EQ(fresh.measurements[i].exposure.end_ns, kept.measurements[i].exposure.end_ns) << i;
  }
}

/// The scores of the frames before a search begins.
struct RepeatedScores final : Observer {
  void began(const Run&, std::size_t) override { has_begun = true; }
  void frame(const Frame&, const Arrival&, std::span<const double> values) override {
    if (!has_begun) scores.push_back(values[0]);
  }
  bool has_begun = false;
  std::vector<double> scores;
};

/// A lens that does not say how it blurs, as none did then: no picture is taken before a search.
class BlurUntold final : public Lens {
 public:
  explicit BlurUntold(std::unique_ptr<Lens> lens) : lens_(std::move(lens)) {}

  LensInfo info() const override {
    LensInfo info = lens_->info();
    info.blur_px_per_unit.reset();
    return info;
  }
  double position() const override { return lens_->position(); }
  Arrival move_to(double position) override { return lens_->move_to(position); }
  Arrival home() override { return lens_->home(); }

 private:
  std::unique_ptr<Lens> lens_;
};

/// Repeated frames, moves and exposures stand where they stood, so the noise is the same.
TEST(StoredRuns, ComeOutOfTheSameRigAgain) {
  for (const char* const name : {"auto.json", "hill.json"}) {
    const RunFile file = stored(name);
    RigOptions options;
    options.rig = file.setup.rig;
    options.metric = file.setup.metric.text();
    options.backend = "cpu";
    Hardware hardware = open_hardware(options.rig);
    hardware.lens = std::make_unique<BlurUntold>(std::move(hardware.lens));
    Rig rig(options, std::move(hardware));
    RepeatedScores repeated;
    FocusRequest request;
    request.search = file.runs[0].limits->search;
    // What was called auto then.
    if (request.search == SearchMethod::automatic) request.search = SearchMethod::coarse;
    const auto fresh = Session(rig).focus(request, repeated);
    FocusLimits kept = *file.runs[0].limits;  // which kept nothing of these:
    kept.search = request.search;
    kept.is_live = fresh.limits->is_live;
    kept.lowest = fresh.limits->lowest;
    kept.highest = fresh.limits->highest;
    EXPECT_EQ(fresh.limits, kept) << name;
    // Version 2 kept the scatter of whole scores; today's is of those without what brightness adds.
    EXPECT_NEAR(relative_scatter(repeated.scores) / file.runs[0].repeat_scatter, 1, 1e-9) << name;
    EXPECT_NEAR(fresh.repeat_scatter / file.runs[0].repeat_scatter, 1, 0.005) << name;
    expect_same_scores(fresh, file.runs[0]);
  }
}

}  // namespace
}  // namespace fathom
