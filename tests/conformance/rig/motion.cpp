// SPDX-License-Identifier: Apache-2.0
// What hal/motion.hpp promises, of every lens that can be watched while it moves.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>

#include "fixtures.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

/// A frame and where its lens stood meanwhile.
struct Seen {
  Exposure exposure;
  std::optional<double> truth;  ///< Of a simulated camera, which knows.
  Where told;
};

class MotionConformance : public RigConformance {
 protected:
  /// Skips the test where the lens cannot be watched.
  void SetUp() override {
    RigConformance::SetUp();
    if (IsSkipped()) return;
    if (!lens().can_be_watched()) GTEST_SKIP() << lens().why_unwatched();
  }

  double resolution() { return lens().info().resolution; }

  /// The middle of the travel, and a place so many times the resolution above it.
  double middle(double above = 0) {
    const LensInfo info = lens().info();
    return lens().nearest(
        std::min((info.lowest + info.highest) / 2 + above * info.resolution, info.highest));
  }

  /// Goes there and waits until the camera has nothing left from before.
  void stand_at(double position) { grab_after(lens().move_to(position).settled_ns); }

  /// Watches a motion to its end.
  std::vector<Seen> watch(Motion& motion) {
    std::vector<Seen> seen;
    while (!motion.arrived()) {
      const Frame frame = grab();
      if (frame.empty()) break;
      seen.push_back({frame.exposure, frame.lens_position, motion.during(frame.exposure)});
    }
    return seen;
  }

  /// Lets the lens make some steps.
  void look_on() {
    for (int i = 0; i < 12; ++i) grab();
  }

  /// From the middle of the travel to a place, or too far below it to take up the play.
  void expect_on_the_way(double position, double target) {
    EXPECT_LE(position, std::max(middle(), target));
    if (target > middle()) {
      EXPECT_GE(position, middle());
    }
  }

  /// The picture of a place, for rigs where it can be recognised.
  std::vector<std::uint32_t> picture_at(double position) {
    return pixels_of(grab_after(lens().move_to(position).settled_ns));
  }
};

TEST_P(MotionConformance, OnTheWayUpItTellsEveryPlaceToWithinAStep) {
  stand_at(middle());
  const auto motion = lens().start(middle(40));
  double before = middle();
  for (const Seen& frame : watch(*motion)) {
    EXPECT_NEAR(frame.told.position, frame.truth.value_or(frame.told.position), resolution());
    EXPECT_LE(frame.told.sigma, resolution());
    EXPECT_GE(frame.told.position, before) << "upward, and never back";
    EXPECT_GE(frame.told.position, middle());
    EXPECT_LE(frame.told.position, middle(40));
    before = frame.told.position;
  }
  const Arrival arrival = motion->wait();
  EXPECT_EQ(arrival.position, middle(40));
  EXPECT_NEAR(motion->at(arrival.settled_ns).position, arrival.position, resolution());
  EXPECT_NEAR(motion->at(arrival.started_ns).position, middle(), resolution());
}

TEST_P(MotionConformance, OnTheWayDownThePlayIsInTheUncertainty) {
  stand_at(middle(40));
  const auto motion = lens().start(middle());
  for (const Seen& frame : watch(*motion)) {
    const double error = frame.told.position - frame.truth.value_or(frame.told.position);
    EXPECT_LE(std::abs(error), resolution() + 2 * frame.told.sigma);
    EXPECT_LE(frame.told.position, middle(40));
  }
  const Arrival arrival = motion->wait();
  EXPECT_NEAR(motion->at(arrival.settled_ns).position, arrival.position,
              resolution() + 2 * motion->at(arrival.settled_ns).sigma);
}

TEST_P(MotionConformance, TheSmearIsTheWayWithinAnExposure) {
  stand_at(middle());
  const auto motion = lens().start(middle(40));
  for (const Seen& frame : watch(*motion)) {
    const double way =
        motion->at(frame.exposure.end_ns).position - motion->at(frame.exposure.start_ns).position;
    EXPECT_NEAR(frame.told.smear, way, resolution());
  }
  const Arrival arrival = motion->wait();
  EXPECT_NEAR(motion->during({arrival.started_ns, arrival.settled_ns}).smear, middle(40) - middle(),
              resolution());
  EXPECT_EQ(motion->at(arrival.stopped_ns).smear, 0);
}

TEST_P(MotionConformance, ArrivesWhereAMoveWould) {
  const LensInfo info = lens().info();
  for (const double share : {0.5, 0.512345, 0.49, 0.0, 0.0, 0.02}) {
    const double place = info.lowest + share * (info.highest - info.lowest);
    std::int64_t settled_ns = 0;
    {
      const auto motion = lens().start(place);
      const Arrival arrival = motion->wait();
      EXPECT_EQ(arrival.position, lens().nearest(place));
      EXPECT_EQ(lens().position(), arrival.position);
      EXPECT_GE(arrival.stopped_ns, arrival.started_ns);
      EXPECT_GE(arrival.settled_ns, arrival.stopped_ns);
      EXPECT_EQ(motion->arrived().value().settled_ns, arrival.settled_ns);
      settled_ns = arrival.settled_ns;
    }
    if (!GetParam().is_noiseless) continue;
    const auto pixels = pixels_of(grab_after(settled_ns));
    EXPECT_EQ(pixels, picture_at(place)) << "share " << share;
  }
}

TEST_P(MotionConformance, RefusesWhatIsBeyondTheLimitsWithoutMoving) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  stand_at(middle());
  const LensInfo info = lens().info();
  for (const double position :
       {info.lowest - 1e-6, info.highest + 1e-6, info.highest + 1e9, kInfinity, -kInfinity}) {
    expect_error(ErrorCode::out_of_bounds, [&] { lens().start(position); });
    EXPECT_EQ(lens().position(), middle());
  }
  expect_error(ErrorCode::bad_argument,
               [&] { lens().start(std::numeric_limits<double>::quiet_NaN()); });
  EXPECT_EQ(lens().position(), middle());
  EXPECT_NO_THROW(lens().start(middle(1))) << "and it is its own again";
}

TEST_P(MotionConformance, StopsOnTheWayAndThePositionIsTrue) {
  const auto before = GetParam().is_noiseless ? picture_at(middle()) : std::vector<std::uint32_t>();
  for (const double target : {lens().info().highest, lens().info().lowest}) {
    stand_at(middle());
    {
      const auto motion = lens().start(target);
      look_on();
      motion->stop();
      const Arrival arrival = motion->wait();
      expect_on_the_way(arrival.position, target);
      EXPECT_EQ(lens().position(), arrival.position);
      if (arrival.note.empty()) {
        EXPECT_EQ(arrival.position, target) << "on a busy machine it may have arrived";
      }
      const Where rest = motion->at(arrival.settled_ns);
      if (target > middle()) {
        EXPECT_NEAR(rest.position, arrival.position, resolution());
      }
      EXPECT_EQ(motion->during({arrival.stopped_ns, arrival.settled_ns}).smear, 0);
      motion->stop();
      EXPECT_EQ(lens().position(), arrival.position) << "stopping what stands changes nothing";
    }
    if (GetParam().is_noiseless) {
      EXPECT_EQ(picture_at(middle()), before) << "still one place";
    }
  }
}

TEST_P(MotionConformance, DestroyedOnTheWayItLeavesATruePosition) {
  const auto before = GetParam().is_noiseless ? picture_at(middle()) : std::vector<std::uint32_t>();
  for (const double target : {lens().info().highest, lens().info().lowest}) {
    stand_at(middle());
    {
      const auto motion = lens().start(target);
      look_on();
    }
    const double stands_at = lens().position();
    expect_on_the_way(stands_at, target);
    EXPECT_EQ(lens().position(), stands_at) << "it stands";
    if (GetParam().is_noiseless) {
      EXPECT_EQ(picture_at(middle()), before) << "still one place";
    }
  }
}

TEST_P(MotionConformance, WhileItLivesTheLensIsItsOwn) {
  stand_at(middle());
  const auto expect_refused = [](auto&& call) { expect_error(ErrorCode::unavailable, call); };
  {
    const auto motion = lens().start(lens().info().highest);
    try {
      lens().position();
      EXPECT_TRUE(motion->arrived()) << "it told a position on the way";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unavailable) << error.what();
    }
    motion->stop();
    motion->wait();
    expect_refused([&] { lens().move_to(middle()); });
    expect_refused([&] { lens().home(); });
    expect_refused([&] { lens().start(middle()); });
    EXPECT_NO_THROW(lens().position());
  }
  EXPECT_EQ(lens().move_to(middle()).position, middle());
}

TEST_P(MotionConformance, TellsNothingOfTimesThatItDoesNotKnow) {
  stand_at(middle());
  const auto motion = lens().start(middle(5));
  const Arrival arrival = motion->wait();
  const auto expect_refused = [](auto&& call) { expect_error(ErrorCode::bad_argument, call); };
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  expect_refused([&] { motion->at(arrival.settled_ns + kHour_ns); });
  expect_refused([&] { motion->during({arrival.started_ns, arrival.settled_ns + kHour_ns}); });
  expect_refused([&] { motion->during({arrival.started_ns - kHour_ns, arrival.started_ns}); });
  expect_refused([&] { motion->during({arrival.settled_ns, arrival.started_ns}); });
  expect_refused([&] { motion->during({}); });
}

TEST_P(MotionConformance, AWishToStopCancelsIt) {
  bool is_armed = false;
  std::atomic<int> asked = 0;  // a motion's own thread asks too
  rig_ = Hardware();  // what belongs to one at a time is given back before it is opened again
  OpenOptions options;
  // The first to ask is the motion, when it begins: what has been asked for until then is old.
  options.stop_requests = [&] { return is_armed && asked++ > 0 ? 1 : 0; };
  rig_ = open(options);
  stand_at(middle());
  {
    is_armed = true;
    const auto motion = lens().start(lens().info().highest);
    expect_error(ErrorCode::cancelled, [&] { motion->wait(); });
    expect_error(ErrorCode::cancelled, [&] { motion->arrived(); });
    EXPECT_NO_THROW(lens().position());
  }
  EXPECT_EQ(lens().move_to(middle()).position, middle()) << "an old wish does not end a new move";
  rig_ = Hardware();  // before the count goes
}

TEST_P(MotionConformance, SomebodyWhoOnlyAsksSeesItArrive) {
  stand_at(middle());
  const auto motion = lens().start(middle(3));
  std::optional<Arrival> arrival;
  while (!arrival) arrival = motion->arrived();
  EXPECT_EQ(arrival->position, middle(3));
}

INSTANTIATE_TEST_SUITE_P(Rigs, MotionConformance, testing::ValuesIn(rig_fixtures()), fixture_label);

class MotionRefusal : public RigConformance {};

TEST_P(MotionRefusal, ALensThatCannotBeWatchedSaysWhy) {
  if (lens().can_be_watched()) GTEST_SKIP() << "it can";
  const double stood = lens().position();
  const std::string why = lens().why_unwatched();
  EXPECT_EQ(why.find('\n'), std::string::npos);
  expect_error(ErrorCode::unsupported, [&] { lens().start(lens().info().highest); },
               {why.c_str(), lens().info().description.c_str()});
  EXPECT_EQ(lens().position(), stood);
}

INSTANTIATE_TEST_SUITE_P(Rigs, MotionRefusal, testing::ValuesIn(rig_fixtures()), fixture_label);

}  // namespace
}  // namespace fathom::test
