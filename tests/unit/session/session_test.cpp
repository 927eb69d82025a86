// SPDX-License-Identifier: Apache-2.0
// A session decides where to look and how often, and tells its observers everything.
#include "session/session.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "focus/noise.hpp"
#include "session/run_keeper.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/unit/session/fake_rig.hpp"

namespace fathom {
namespace {

using test::Bench;
using test::expect_error;
using test::Faults;

/// Keeps all that it is told.
struct Witness final : Observer {
  std::string order;  ///< f, b, e, o (found), w: what came when.
  std::size_t positions = 0;
  std::vector<double> scores, places;
  std::vector<Measurement> measurements;
  std::vector<Focus> foci;
  std::vector<Warning> warnings;

  void began(const Run& run, std::size_t count) override {
    order += 'b';
    positions = count;
    EXPECT_TRUE(run.measurements.empty());
  }
  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> given) override {
    order += 'f';
    EXPECT_EQ(frame.width_px(), 16);
    ASSERT_EQ(given.size(), 1u);
    places.push_back(arrival.position);
    scores.push_back(given[0]);
  }
  void evaluated(const Measurement& measurement) override {
    order += 'e';
    measurements.push_back(measurement);
  }
  void found(const Focus& focus) override {
    order += 'o';
    foci.push_back(focus);
  }
  void warned(const Warning& warning) override {
    order += 'w';
    warnings.push_back(warning);
  }

  template <class Kind>
  std::vector<Kind> all() const {
    std::vector<Kind> some;
    for (const Warning& warning : warnings) {
      if (const Kind* const one = std::get_if<Kind>(&warning)) some.push_back(*one);
    }
    return some;
  }
};

TEST(Session, TellsAFocusStepByStep) {
  Bench bench({});
  Rig rig = bench.rig();
  Witness witness;
  const auto run = Session(rig).focus({}, witness);
  ASSERT_TRUE(run.focus && run.limits);
  EXPECT_NEAR(run.focus->position(), 60, 0.5);
  std::string expected(kRepeatFrames, 'f');
  expected += 'b';
  for (std::size_t i = 0; i < run.measurements.size(); ++i) expected += "fe";
  EXPECT_EQ(witness.order, expected + "o");
  EXPECT_EQ(witness.positions, 0u);
  ASSERT_EQ(witness.measurements.size(), run.measurements.size());
  for (std::size_t i = 0; i < run.measurements.size(); ++i) {
    EXPECT_EQ(witness.measurements[i].score, run.measurements[i].score);
    EXPECT_EQ(witness.scores[kRepeatFrames + i], run.measurements[i].score);
    const std::size_t searched = run.focus->evaluations.size();
    const Evaluation& evaluation =
        i < searched ? run.focus->evaluations[i] : run.focus->second_looks.at(i - searched);
    EXPECT_EQ(evaluation.position, run.measurements[i].position);
  }
  EXPECT_EQ(witness.foci.at(0).position(), run.focus->position());
}

/// One rule for every search: where it begins, and a climb begins where the lens stands.
TEST(Session, RepeatsFramesWhereTheSearchBegins) {
  struct Case {
    FocusRequest request;
    double at;
  };
  FocusRequest bracketed, climbing, told;
  bracketed.bracket = Bracket{30, 50, 90};
  bracketed.search = SearchMethod::golden;
  climbing.search = told.search = SearchMethod::hill;
  told.start = 44;
  for (const Case& one : {Case{{}, 0}, Case{FocusRequest::within(20, 90), 20}, Case{bracketed, 30},
                          Case{climbing, 7}, Case{told, 44}}) {
    Bench bench({});
    Rig rig = bench.rig();
    Witness witness;
    Session(rig).focus(one.request, witness);
    ASSERT_EQ(witness.order.find('b'), static_cast<std::size_t>(kRepeatFrames));
    for (int i = 0; i < kRepeatFrames; ++i) EXPECT_EQ(witness.places[i], one.at);
  }
}

TEST(Session, RepeatsNoFrameOfARecording) {
  Bench bench({.is_recorded = true});
  Rig rig = bench.rig();
  Witness witness;
  const auto run = Session(rig).focus({}, witness);
  EXPECT_EQ(witness.order.front(), 'b');
  EXPECT_EQ(run.repeat_scatter, 0);
}

TEST(Session, TracksWithinTheLimitsOfTheRunBefore) {
  Bench bench({});
  Rig rig = bench.rig();
  RunKeeper keeper(setup_of(rig));
  Session session(rig);
  session.focus(FocusRequest::within(10, 90), keeper);
  Witness witness;
  Observers both({&keeper, &witness});
  const auto tracked = session.track(keeper.file.runs[0], both);
  EXPECT_TRUE(tracked.tracks);
  EXPECT_EQ(tracked.limits, keeper.file.runs[0].limits);
  EXPECT_EQ(tracked.repeat_scatter, keeper.file.runs[0].repeat_scatter);
  EXPECT_EQ(witness.order.front(), 'b') << "no repeated frames";
  EXPECT_NEAR(tracked.focus->position(), 60, 0.5);
  EXPECT_LT(tracked.measurements.size(), keeper.file.runs[0].measurements.size());
  EXPECT_FALSE(tracked.focus->background.empty());
  ASSERT_EQ(keeper.file.runs.size(), 2u);
  EXPECT_TRUE(same_answer(keeper.file, rerun(keeper.file, "kept")));
}

TEST(Session, SweepsUpwardAndTakesEachPositionOnce) {
  Bench bench({});
  Rig rig = bench.rig();
  Witness witness;
  const auto run = Session(rig).sweep({40, 80, 5}, witness);
  EXPECT_FALSE(run.focus || run.limits);
  EXPECT_EQ(witness.positions, 9u);
  ASSERT_EQ(run.measurements.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(run.measurements[i].position, 40 + 5 * static_cast<double>(i));
  EXPECT_EQ(witness.order, "bfefefefefefefefefe");
  expect_error(ErrorCode::bad_argument, [&] { Session(rig).sweep({40, 80, -1}, witness); });
  expect_error(ErrorCode::out_of_bounds, [&] { Session(rig).sweep({40, 180, 5}, witness); });
}

TEST(SessionWarns, OfPositionsThatTheLensDoesNotHave) {
  Bench bench({});
  Rig rig = bench.rig();
  Witness witness;
  FocusRequest request;
  request.search = SearchMethod::golden;
  const double rounded = std::nextafter(55.0, 56.0);
  request.bracket = Bracket{40.25, rounded, 79.5};
  Session(rig).focus(request, witness);
  const auto inexact = witness.all<InexactPositions>();
  ASSERT_EQ(inexact.size(), 1u);
  EXPECT_EQ(inexact[0].unit, "steps");
  ASSERT_EQ(inexact[0].places.size(), 2u) << "what rounding alone moves is there";
  EXPECT_EQ(inexact[0].places[0].wanted, 40.25);
  EXPECT_EQ(inexact[0].places[0].nearest, 40);
  EXPECT_EQ(inexact[0].places[1].wanted, 79.5);
  EXPECT_EQ(witness.order.front(), 'w') << "before anything is measured";
}

TEST(SessionWarns, OfASweepFinerThanTheLens) {
  Bench bench({});
  Rig rig = bench.rig();
  Witness witness;
  const auto run = Session(rig).sweep({40, 42, 0.25}, witness);
  const auto fine = witness.all<StepTooFine>();
  ASSERT_EQ(fine.size(), 1u);
  EXPECT_EQ(fine[0].step, 0.25);
  EXPECT_EQ(fine[0].resolution, 1);
  EXPECT_EQ(run.measurements.size(), 3u);
}

TEST(SessionWarns, OfLostFramesInEveryKindOfRun) {
  Bench bench({.drops_each = 2});
  Rig rig = bench.rig();
  Session session(rig);
  Witness found, tracked, swept;
  const auto run = session.focus({}, found);
  session.track(run, tracked);
  session.sweep({40, 80, 20}, swept);
  for (const Witness* witness : {&found, &tracked, &swept}) {
    const auto lost = witness->all<LostFrames>();
    ASSERT_EQ(lost.size(), 1u);
    EXPECT_EQ(lost[0].during.delivered, witness->scores.size());
    EXPECT_EQ(lost[0].during.dropped, 2 * witness->scores.size()) << "of this run alone";
  }
}

TEST(SessionWarns, OfSaturationInEveryKindOfRun) {
  Bench bench({.gain = 300});
  Rig rig = bench.rig();
  Session session(rig);
  Witness found, tracked, swept;
  const auto run = session.focus({}, found);
  session.track(run, tracked);
  session.sweep({40, 80, 20}, swept);
  for (const Witness* witness : {&found, &tracked, &swept}) {
    const auto bright = witness->all<Saturation>();
    ASSERT_EQ(bright.size(), 1u);
    EXPECT_EQ(bright[0].part, 0.5);
  }
}

TEST(SessionWarns, OfWhatTheLensSaysOfItsMoves) {
  Bench bench({.note = "lost 3 steps"});
  Rig rig = bench.rig();
  Witness witness;
  const auto run = Session(rig).sweep({40, 80, 20}, witness);
  const auto notes = witness.all<LensNote>();
  ASSERT_EQ(notes.size(), run.measurements.size());
  EXPECT_EQ(notes[1].position, 60);
  EXPECT_EQ(notes[1].text, "lost 3 steps");
}

// The longest move is the one to where the search begins, and frames are repeated there.
TEST(SessionWarns, OfWhatTheLensSaysOfTheFirstMoveOfASearch) {
  Bench bench({.note = "lost 3 steps"});
  Rig rig = bench.rig();
  Witness witness;
  const auto run = Session(rig).focus({}, witness);
  const auto notes = witness.all<LensNote>();
  ASSERT_EQ(notes.size(), run.measurements.size() + 1);
  EXPECT_EQ(notes[0].position, run.limits->from);
}

TEST(SessionWarns, OfALensThatCannotGoBack) {
  Bench bench({.stays_after = 3});
  Rig rig = bench.rig();
  Witness witness;
  {
    const LensReturn put_back(rig.lens(), witness);
    Session(rig).sweep({40, 80, 20}, witness);
  }
  const auto lost = witness.all<LensNotReturned>();
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_EQ(lost[0].position, 7);
  EXPECT_NE(lost[0].why.find("unplugged"), std::string::npos);
}

TEST(SessionWarns, OfNothingWhereAllIsWell) {
  Bench bench({});
  Rig rig = bench.rig();
  Witness witness;
  Session session(rig);
  session.track(session.focus({}, witness), witness);
  session.sweep({40, 80, 20}, witness);
  EXPECT_TRUE(witness.warnings.empty());
}

/// Nothing measured is ever lost.
TEST(RunKeeper, KeepsWhatWasMeasuredUntilTheCameraWasUnplugged) {
  Bench bench({.lost_after = kRepeatFrames + 6});
  Rig rig = bench.rig();
  RunKeeper keeper(setup_of(rig));
  keeper.target_at(1500);
  expect_error(ErrorCode::device_lost, [&] { Session(rig).focus({}, keeper); });
  ASSERT_EQ(keeper.file.runs.size(), 1u);
  const auto& run = keeper.file.runs[0];
  EXPECT_EQ(run.measurements.size(), 6u);
  EXPECT_EQ(run.target_mm, 1500);
  EXPECT_TRUE(run.limits && !run.focus);
  EXPECT_EQ(RunFile::parse(keeper.file.json(), "kept").runs[0].measurements.size(), 6u);
}

TEST(RunKeeper, KeepsRunsThatComputeAgain) {
  Bench bench({});
  Rig rig = bench.rig();
  RunKeeper keeper(setup_of(rig));
  Session session(rig);
  const auto run = session.focus({}, keeper);
  session.sweep({40, 80, 20}, keeper);
  ASSERT_EQ(keeper.file.runs.size(), 2u);
  EXPECT_EQ(keeper.file.runs[0].measurements.size(), run.measurements.size());
  EXPECT_EQ(keeper.file.runs[1].measurements.size(), 3u);
  EXPECT_EQ(keeper.file.setup.camera, "fake camera");
  const RunFile read = RunFile::parse(keeper.file.json(), "kept");
  EXPECT_TRUE(same_answer(read, rerun(read, "kept")));
}

/// Whoever cannot go on ends the run, and those before it have been told.
TEST(Observers, AreToldInOrderUntilOneFails) {
  struct Failing final : Observer {
    void evaluated(const Measurement&) override { throw Error(ErrorCode::io, "the disk is full"); }
  };
  Bench bench({});
  Rig rig = bench.rig();
  Witness first, last;
  Failing failing;
  Observers all({&first, &failing, &last});
  expect_error(ErrorCode::io, [&] { Session(rig).sweep({40, 80, 20}, all); }, {"disk"});
  EXPECT_EQ(first.measurements.size(), 1u);
  EXPECT_TRUE(last.measurements.empty());
  EXPECT_EQ(first.order, "bfe");
}

}  // namespace
}  // namespace fathom
