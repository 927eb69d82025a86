// SPDX-License-Identifier: Apache-2.0
// A sweep without a halt: every frame has its own place, and what they leave out is visited.
#include "session/passing.hpp"

#include <gtest/gtest.h>

#include "session/run_keeper.hpp"
#include "session/session.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/unit/session/fake_rig.hpp"

namespace fathom {
namespace {

using test::Bench;
using test::expect_error;
using test::Faults;

constexpr int kSlow_ns = 20;  ///< Two frames a step.

struct Warned final : Observer {
  std::vector<FewOnTheWay> few;
  std::size_t frames = 0;
  void frame(const Frame&, const Arrival&, std::span<const double>) override { ++frames; }
  void warned(const Warning& warning) override { few.push_back(std::get<FewOnTheWay>(warning)); }
};

const Sweep kAll{.from = 20, .to = 90, .step = {}, .is_moving = true};

TEST(PassingSweep, ScoresEveryFrameWhereTheLensStood) {
  Bench bench({.step_ns = kSlow_ns});
  Rig rig = bench.rig();
  Warned observer;
  const auto run = Session(rig).sweep(kAll, observer);
  EXPECT_EQ(bench.world.moves, std::vector<double>{20}) << "one move to where it begins";
  EXPECT_TRUE(observer.few.empty());
  EXPECT_EQ(observer.frames, run.measurements.size());
  ASSERT_GE(run.measurements.size(), 140u);
  double last = 0;
  for (const Measurement& m : run.measurements) {
    ASSERT_TRUE(m.on_the_way);
    EXPECT_GT(m.position, last);
    EXPECT_EQ(m.on_the_way->sigma, 0.25);
    EXPECT_LE(m.on_the_way->smear, 0.5);
    EXPECT_LE(m.started_ns, m.stopped_ns);
    EXPECT_LE(m.settled_ns, m.exposure.start_ns);
    last = m.position;
  }
  EXPECT_EQ(last, 90) << "the last one is at rest";
  EXPECT_NEAR(best_of(run.evaluations()).position, 60, 1);
  EXPECT_EQ(journey_of(run).travel, 13 + 70);
  const TimeSpent spent = time_spent(run.measurements);
  EXPECT_NEAR(spent.moving + spent.settling + spent.exposing, journey_of(run).rig_seconds, 1e-9)
      << "no time is left out";
}

TEST(PassingSweep, KeepsAStepApart) {
  Bench bench({.step_ns = kSlow_ns});
  Rig rig = bench.rig();
  Warned observer;
  const auto run =
      Session(rig).sweep({.from = 20, .to = 90, .step = 5, .is_moving = true}, observer);
  EXPECT_TRUE(observer.few.empty());
  EXPECT_GE(run.measurements.size(), 13u);
  for (std::size_t i = 1; i < run.measurements.size(); ++i)
    EXPECT_GE(run.measurements[i].position - run.measurements[i - 1].position, 5);
}

TEST(PassingSweep, DropsFramesFromBeforeItBegan) {
  Bench bench({.queued = 4, .step_ns = kSlow_ns});
  Rig rig = bench.rig();
  Warned observer;
  const auto run = Session(rig).sweep(kAll, observer);
  ASSERT_EQ(observer.few.size(), 1u);
  EXPECT_EQ(observer.few[0].unplaced, 0) << "nobody asked where they are of";
  EXPECT_EQ(observer.few[0].visited, 2) << "the lens went on while they came";
  EXPECT_GT(run.measurements.front().exposure.start_ns, 3000) << "when it had settled";
}

// Ten steps in one exposure are no place of a curve whose positions are a step apart.
TEST(PassingSweep, VisitsWhatTooQuickALensLeavesOut) {
  Bench bench({.step_ns = 1});
  Rig rig = bench.rig();
  Warned observer;
  const auto run = Session(rig).sweep(kAll, observer);
  ASSERT_EQ(observer.few.size(), 1u);
  EXPECT_EQ(observer.few[0].unplaced, 0);
  EXPECT_GE(observer.few[0].smeared, 6);
  EXPECT_GE(observer.few[0].visited, 60);
  EXPECT_NEAR(best_of(run.evaluations()).position, 60, 1);
  for (const Measurement& m : run.measurements) {
    EXPECT_LE(m.on_the_way.value_or(OnTheWay{}).smear, 2);
  }
}

TEST(PassingSweep, EndsWithTheMotorAndKeepsWhatItHas) {
  Bench bench({.step_ns = kSlow_ns, .fails_at = 50});
  Rig rig = bench.rig();
  RunKeeper keeper(setup_of(rig));
  expect_error(ErrorCode::device_lost, [&] { Session(rig).sweep(kAll, keeper); }, {"burns"});
  ASSERT_EQ(keeper.file.runs.size(), 1u);
  EXPECT_GT(keeper.file.runs[0].measurements.size(), 50u);
  EXPECT_FALSE(bench.world.is_moving);
}

TEST(PassingSweep, EndsOnAWishOnTheWay) {
  Bench bench({.step_ns = kSlow_ns});
  bench.options.shot.stop_requests = [&] { return bench.world.frames >= 10 ? 1 : 0; };
  Rig rig = bench.rig();
  RunKeeper keeper(setup_of(rig));
  expect_error(ErrorCode::cancelled, [&] { Session(rig).sweep(kAll, keeper); });
  EXPECT_EQ(keeper.file.runs[0].measurements.size(), 10u);
  EXPECT_FALSE(bench.world.is_moving);
  EXPECT_LT(bench.world.position, 30) << "it did not go on";
}

TEST(PassingSweep, RefusesRigsThatHaveNoFramesOnTheWay) {
  Bench plain({}), recorded({.is_recorded = true, .step_ns = kSlow_ns}),
      averaged({.step_ns = kSlow_ns});
  averaged.options.shot.average = 2;
  const auto refuses = [](Bench& bench, ErrorCode code, const char* why) {
    Rig rig = bench.rig();
    Observer nobody;
    expect_error(code, [&] { Session(rig).sweep(kAll, nobody); }, {why});
    EXPECT_TRUE(bench.world.moves.empty());
  };
  refuses(plain, ErrorCode::unsupported, "only at rest");
  refuses(recorded, ErrorCode::unsupported, "no live camera");
  refuses(averaged, ErrorCode::bad_argument, "cannot be averaged");
}

TEST(PassingSweep, StandsInTheRunFile) {
  Bench bench({.step_ns = kSlow_ns});
  Rig rig = bench.rig();
  RunKeeper keeper(setup_of(rig));
  Session(rig).sweep(kAll, keeper);
  const RunFile read = RunFile::parse(keeper.file.json(), "kept");
  const auto& kept = read.runs[0].measurements;
  ASSERT_EQ(kept.size(), keeper.file.runs[0].measurements.size());
  ASSERT_TRUE(kept[7].on_the_way);
  EXPECT_EQ(kept[7].on_the_way->sigma, 0.25);
  EXPECT_EQ(kept[7].on_the_way->smear, keeper.file.runs[0].measurements[7].on_the_way->smear);
  EXPECT_EQ(read.json(), keeper.file.json());
}

}  // namespace
}  // namespace fathom
