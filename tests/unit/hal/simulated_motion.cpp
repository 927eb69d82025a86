// SPDX-License-Identifier: Apache-2.0
// Pictures of a lens that moves while they are exposed, against pictures of it at rest.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "hal/drivers/simulated/course.hpp"
#include "hal/drivers/simulated/motor.hpp"
#include "hal/drivers/simulated/trail.hpp"
#include "simulated_support.hpp"

namespace fathom {
namespace {

using namespace std::chrono_literals;
using test::pixels;
using test::SimulatedRig;

using Shares = std::map<int, double>;

/// A picture of the lens at rest.
std::vector<std::uint32_t> still_at(const std::string& text, int position) {
  SimulatedRig rig(text);
  rig.lens().move_to(position);
  return pixels(rig.grab());
}

/// Counts the pixels of a frame that the stills' mean explains to within rounding. Pixels that any
/// still saturates do not count: there the light has more to say than the grey values.
void expect_mean_of_stills(const Frame& frame, const std::string& text, const Shares& shares) {
  std::vector<double> mean(256 * 240, 0);
  std::vector<bool> is_bright(mean.size(), false);
  for (const auto& [position, share] : shares) {
    const auto still = still_at(text, position);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] += share * still[i];
      is_bright[i] = is_bright[i] || still[i] > 250;
    }
  }
  const auto seen = pixels(frame);
  int compared = 0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    if (is_bright[i]) continue;
    ++compared;
    ASSERT_NEAR(seen[i], mean[i], 1.001) << "pixel " << i;
  }
  EXPECT_GT(compared, 15'000);
}

TEST(SimulatedMotion, AMovingExposureIsTheMeanOfItsPlaces) {
  // A step takes 25 ms, an exposure 40: the first frame sees 740 for 25 ms and 741 for 15.
  const std::string text = "sim:noise=0,drift=0,distance=1800,rate=40,exposure_ms=40";
  SimulatedRig rig(text + ",start=740");
  const auto motion = rig.lens().start(780);
  expect_mean_of_stills(rig.grab(), text, {{740, 25.0 / 40}, {741, 15.0 / 40}});
  const Frame second = rig.grab();  // 40 to 80 ms
  EXPECT_EQ(second.exposure.start_ns, 40'000'000);
  expect_mean_of_stills(second, text, {{741, 10.0 / 40}, {742, 25.0 / 40}, {743, 5.0 / 40}});
  EXPECT_DOUBLE_EQ(second.lens_position.value(), (741 * 10 + 742 * 25 + 743 * 5) / 40.0);
}

TEST(SimulatedMotion, ALongExposureIsTheMeanOfMany) {
  const std::string text = "sim:target=seedling,noise=0,drift=0,rate=40,exposure_ms=100";
  SimulatedRig rig(text + ",start=700");
  const auto motion = rig.lens().start(900);
  rig.grab();
  const Frame frame = rig.grab();
  const Where told = motion->during(frame.exposure);
  Shares shares;
  for (int i = 4; i < 8; ++i) shares[700 + i] = 1.0 / 4;
  expect_mean_of_stills(frame, text, shares);
  EXPECT_DOUBLE_EQ(told.position, 705.5);
  EXPECT_EQ(told.smear, 3);
}

TEST(SimulatedMotion, SmearMakesPicturesDifferentFromAnyStill) {
  const std::string text = "sim:noise=0,drift=0,rate=40,exposure_ms=40,distance=1800";
  SimulatedRig rig(text + ",start=760");
  const auto motion = rig.lens().start(800);
  const auto seen = pixels(rig.grab());
  EXPECT_NE(seen, still_at(text, 760));
  EXPECT_NE(seen, still_at(text, 761));
}

TEST(SimulatedMotion, WithNoiseItIsTheMeanToWithinTheNoise) {
  SimulatedRig rig("sim:drift=0,rate=40,exposure_ms=40,start=740"),
      quiet("sim:drift=0,rate=40,exposure_ms=40,start=740,noise=0");
  const auto noisy_motion = rig.lens().start(780), quiet_motion = quiet.lens().start(780);
  const auto noisy = pixels(rig.grab()), clean = pixels(quiet.grab());
  double squares = 0, sum = 0;
  int compared = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    if (clean[i] > 240) continue;
    const double difference = static_cast<double>(noisy[i]) - clean[i];
    sum += difference;
    squares += difference * difference;
    ++compared;
  }
  ASSERT_GT(compared, 10'000);
  EXPECT_NEAR(sum / compared, 0, 0.1);
  EXPECT_LT(std::sqrt(squares / compared), 2.5) << "shot, read and pattern noise of some 200 greys";
  EXPECT_GT(std::sqrt(squares / compared), 0.8);
}

TEST(SimulatedMotion, TheLensLagsBehindOnTheWayDown) {
  SimulatedRig rig("sim:target=blank,backlash=9,start=700");
  const auto motion = rig.lens().start(650);
  double lowest = 700;
  while (!motion->arrived()) {
    const Frame frame = rig.grab();
    EXPECT_DOUBLE_EQ(motion->during(frame.exposure).position, frame.lens_position.value());
    EXPECT_GE(frame.lens_position.value(), lowest - 2) << "never far below the last";
    lowest = std::min(lowest, frame.lens_position.value());
  }
  EXPECT_EQ(lowest, 650) << "the motor goes 9 steps farther, the lens does not";
}

TEST(SimulatedMotion, ArrivesWhenAMoveWould) {
  for (const int to : {760, 700, 650, 0}) {
    SimulatedRig moved("sim:start=700"), watched("sim:start=700");
    const Arrival expected = moved.lens().move_to(to);
    const auto motion = watched.lens().start(to);
    const Arrival arrival = motion->wait();
    EXPECT_EQ(arrival.position, expected.position);
    EXPECT_EQ(arrival.started_ns, expected.started_ns);
    EXPECT_EQ(arrival.stopped_ns, expected.stopped_ns);
    EXPECT_EQ(arrival.settled_ns, expected.settled_ns);
    EXPECT_EQ(arrival.note, "");
  }
}

TEST(SimulatedMotion, LosesTheSameStepsAsAMove) {
  for (const char* text : {"sim:noise=0,drift=0,lose=60", "sim:noise=0,drift=0,rate=60"}) {
    SimulatedRig moved(text), watched(text);
    moved.lens().move_to(780);
    watched.lens().start(780)->wait();
    EXPECT_EQ(watched.lens().position(), 780) << "it does not know";
    EXPECT_EQ(pixels(watched.grab()), pixels(moved.grab())) << text;
  }
}

TEST(SimulatedMotion, StopsAtOnceAndIsOnePlaceAfterwards) {
  const std::string text = "sim:noise=0,drift=0,backlash=9,start=700";
  SimulatedRig rig(text);
  {
    const auto motion = rig.lens().start(600);
    while (motion->at(rig.grab().exposure.end_ns).position > 680) {
    }
    motion->stop();
    const Arrival arrival = motion->wait();
    EXPECT_NEAR(arrival.position, 680 - 9, 1) << "where the motor stands, the play below the lens";
    EXPECT_NEAR(motion->at(arrival.settled_ns).position, 680, 1);
  }
  rig.lens().move_to(675);
  EXPECT_EQ(pixels(rig.grab()), still_at(text, 675));
}

TEST(SimulatedMotion, AFrameThatTakesTooLongSeesTheWholeWay) {
  SimulatedRig rig("sim:target=blank,exposure_ms=100,start=700");
  const auto motion = rig.lens().start(710);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(rig.camera().grab(30ms));
  const auto frame = rig.camera().grab(30ms);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->exposure.start_ns, 0);
  EXPECT_DOUBLE_EQ(frame->lens_position.value(), (700 * 40 + 701 * 40 + 702 * 20) / 100.0);
  EXPECT_DOUBLE_EQ(motion->during(frame->exposure).position, frame->lens_position.value());
}

TEST(SimulatedMotion, AnExposureMaySpanTwoMotions) {
  SimulatedRig rig("sim:target=blank,exposure_ms=200,start=700");
  rig.lens().start(800);
  EXPECT_EQ(rig.lens().position(), 700) << "destroyed at once, it has not moved";
  {
    const auto first = rig.lens().start(800);
    EXPECT_FALSE(rig.camera().grab(100ms));  // two steps
  }
  EXPECT_EQ(rig.lens().position(), 702);
  const auto second = rig.lens().start(800);
  const Frame frame = rig.grab();
  EXPECT_EQ(frame.exposure.start_ns, 0);
  // 700 and 701 for 40 ms each, 702 from 80 ms to the first step of the second motion at 140.
  EXPECT_NEAR(frame.lens_position.value(),
              (700 * 40 + 701 * 40 + 702 * 60 + 703 * 40 + 704 * 20) / 200.0, 1e-9);
}

TEST(SimulatedCourse, EndsWhenItsLegsWouldTogether) {
  simulated::Motor motor(1, 0, 4, 30);
  std::int64_t end_ns = 1000;
  for (const int leg : {-7, 4, 100}) end_ns += motor.step_ns(leg);
  simulated::Course course({-7, 4, 100}, 1000, 30);
  int place = 0, steps = 0;
  std::int64_t last_ns = 1000;
  for (; !course.is_over(); course.advance()) {
    EXPECT_GE(course.next_ns() - last_ns, 33'333'332);
    last_ns = course.next_ns();
    place += course.direction();
    ++steps;
  }
  EXPECT_EQ(place, 97);
  EXPECT_EQ(steps, 111);
  EXPECT_EQ(last_ns, end_ns);
}

TEST(SimulatedTrail, ForgetsNoPlaceThatAnExposureMaySee) {
  simulated::Trail trail;
  for (int i = 0; i < 10; ++i) trail.add(100 * i, i);
  trail.forget_before(450);
  EXPECT_TRUE(trail.covers({450, 460}));
  EXPECT_FALSE(trail.covers({900, 950}));
  const auto stays = trail.stays({450, 650});
  ASSERT_EQ(stays.size(), 3U);
  EXPECT_EQ(stays[0].lens, 4);
  EXPECT_DOUBLE_EQ(stays[0].share, 0.25);
  EXPECT_DOUBLE_EQ(stays[1].share, 0.5);
  EXPECT_DOUBLE_EQ(stays[2].share, 0.25);
}

}  // namespace
}  // namespace fathom
