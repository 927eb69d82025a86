// SPDX-License-Identifier: Apache-2.0
// A whole search on a rig whose parts fail on purpose: what it says, and where it leaves the lens.
#include "session/session.hpp"

#include <gtest/gtest.h>

#include "focus/noise.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/unit/session/fake_rig.hpp"

namespace fathom {
namespace {

using test::Bench;
using test::expect_error;
using test::Faults;

/// Keeps what was measured, whatever ends the search.
class Log final : public Observer {
 public:
  explicit Log(std::vector<Measurement>& log) : log_(log) {}
  void evaluated(const Measurement& m) override { log_.push_back(m); }

 private:
  std::vector<Measurement>& log_;
};

/// A search as the program does it, lens put back in the end.
Focus search(Rig& rig, std::vector<Measurement>& log) {
  const LensReturn put_back(rig.lens());
  Log keep(log);
  return *Session(rig).focus({}, keep).focus;
}

TEST(RigWithFakes, FindsItsFocusAndGoesBack) {
  Bench bench({});
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  const Focus focus = search(rig, log);
  EXPECT_EQ(focus.result(), FocusResult::focused) << to_string(focus.verdict.reason.why);
  EXPECT_NEAR(focus.position(), 60, 0.5);
  EXPECT_EQ(bench.world.position, 7);
}

/// What waited in the camera's queue while the lens moved is no repeat of what it sees now.
TEST(RigWithFakes, RepeatsOfAStillSceneScatterByNoiseAlone) {
  Bench bench({.queued = 4});
  Rig rig = bench.rig();
  EXPECT_LT(rig.repeat_scatter(60, kRepeatFrames), 1e-12);
  EXPECT_GT(bench.world.frames, kRepeatFrames + 3) << "the old ones were offered";
}

TEST(RigWithFakes, LogsTheTimesOfEveryStep) {
  Bench bench({});
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  search(rig, log);
  for (const Measurement& m : log) {
    EXPECT_EQ(m.stopped_ns - m.started_ns, 2000);
    EXPECT_EQ(m.settled_ns - m.stopped_ns, 1000);
    EXPECT_GE(m.exposure.start_ns, m.settled_ns);
    EXPECT_GT(m.compute_ns, 0);
  }
  const TimeSpent spent = time_spent(log);
  EXPECT_NEAR(spent.moving, 2e-6 * static_cast<double>(log.size()), 1e-12);
  EXPECT_NEAR(spent.settling, 1e-6 * static_cast<double>(log.size()), 1e-12);
}

TEST(RigWithFakes, ALensThatIsBlockedIsAnError) {
  Faults faults;
  faults.stuck_at = 30;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::device_lost, [&] { search(rig, log); },
               {"stands at 30 steps", "sent to 40", "blocked"});
  EXPECT_EQ(log.size(), 4u) << "what was measured is kept: 0, 10, 20, 30";
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, AnEncodersLastDigitIsNone) {
  Faults faults;
  faults.encoder_error = 0.3;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  const Focus focus = search(rig, log);
  EXPECT_EQ(focus.result(), FocusResult::focused);
  ASSERT_EQ(log.size(), focus.evaluations.size() + focus.second_looks.size());
  // A rerun looks for the positions that the search asked for.
  for (std::size_t i = 0; i < focus.evaluations.size(); ++i)
    EXPECT_EQ(log[i].position, focus.evaluations[i].position);
}

TEST(RigWithFakes, PicturesThatNeverChangeAreNoFocus) {
  Faults faults;
  faults.freezes = true;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  const Focus focus = search(rig, log);
  EXPECT_EQ(focus.result(), FocusResult::no_focus);
  EXPECT_EQ(focus.verdict.reason.why, Why::all_alike);
}

TEST(RigWithFakes, ACameraThatRepeatsItsOldFrameTimesOut) {
  Faults faults;
  faults.freezes = faults.freezes_stamps = true;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::timeout, [&] { search(rig, log); }, {"fake camera", "fresh ones"});
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, ACameraThatIsUnpluggedLeavesTheLensSafe) {
  Faults faults;
  faults.lost_after = kRepeatFrames + 6;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::device_lost, [&] { search(rig, log); }, {"unplugged"});
  EXPECT_EQ(log.size(), 6u);
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, StopsOnRequestWithTheLensBack) {
  Bench bench({});
  int asked = 0;
  bench.options.shot.stop_requests = [&] { return ++asked > 20 ? 1 : 0; };
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::cancelled, [&] { search(rig, log); });
  EXPECT_GT(log.size(), 3u);
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, MeasuresHowMuchOfTheWindowIsSaturated) {
  for (const int gain : {100, 300}) {
    Faults faults;
    faults.gain = gain;
    Bench bench(faults);
    EXPECT_EQ(bench.rig().measure(60).picture.saturated, gain == 100 ? 0 : 0.5);
  }
}

TEST(RigWithFakes, RefusesAMetricOfSeveralNumbers) {
  Bench bench({});
  bench.options.metric = "fft:16:hann:power:rings=4";
  expect_error(ErrorCode::bad_argument, [&] { bench.rig(); }, {"rings=4", "4 numbers"});
}

TEST(RigWithFakes, RefusesAnAverageOfNothing) {
  Bench bench({});
  bench.options.shot.average = 0;
  expect_error(ErrorCode::bad_argument, [&] { bench.rig(); }, {"0 frames"});
}

}  // namespace
}  // namespace fathom
