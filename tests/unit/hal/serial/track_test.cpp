// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/track.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

using serial::Track;

constexpr std::int64_t kMs_ns = 1'000'000;

TEST(SerialTrack, IsTheLineThroughWhatWasSaid) {
  Track track(10, true, 0, 0, 0);
  track.add(10, 0, 0);
  track.add(20, 100 * kMs_ns, 100 * kMs_ns);
  track.add(30, 200 * kMs_ns, 200 * kMs_ns);
  const Where where = track.during({50 * kMs_ns, 150 * kMs_ns}, 300 * kMs_ns);
  EXPECT_NEAR(where.position, 20, 1e-9);
  EXPECT_NEAR(where.smear, 10, 1e-9);
  EXPECT_NEAR(track.during({100 * kMs_ns, 100 * kMs_ns}, 300 * kMs_ns).position, 20, 1e-9);
}

TEST(SerialTrack, KnowsThePlaceLessTheSlowerTheAnswer) {
  Track track(0, true, 0, 0, 0);
  track.add(0, 0, 0);
  track.add(100, 90 * kMs_ns, 110 * kMs_ns);
  track.add(200, 190 * kMs_ns, 210 * kMs_ns);
  track.add(300, 290 * kMs_ns, 310 * kMs_ns);
  // One unit a millisecond, ten milliseconds either way, evenly.
  EXPECT_NEAR(track.during({120 * kMs_ns, 180 * kMs_ns}, 400 * kMs_ns).sigma, 10 / std::sqrt(3.0),
              1e-9);
}

TEST(SerialTrack, KnowsThePlaceWhereItStoodBeforeItsOrder) {
  Track track(0, true, 0, 0, 0);
  track.depart(1000 * kMs_ns);
  track.add(5, 1010 * kMs_ns, 1010 * kMs_ns);
  EXPECT_EQ(track.during({100 * kMs_ns, 900 * kMs_ns}, 2000 * kMs_ns).sigma, 0);
  EXPECT_GT(track.during({100 * kMs_ns, 1005 * kMs_ns}, 2000 * kMs_ns).sigma, 0);
}

TEST(SerialTrack, LagsBehindByThePlayOnTheWayDown) {
  Track track(50, true, 4, 0, 0);
  track.add(40, 100 * kMs_ns, 100 * kMs_ns);
  const Where where = track.during({100 * kMs_ns, 100 * kMs_ns}, 200 * kMs_ns);
  EXPECT_NEAR(where.position, 42, 1e-9);
  EXPECT_GE(where.sigma, 4 / std::sqrt(12.0));
  EXPECT_FALSE(track.is_taken_up());
  track.arrive(44, 200 * kMs_ns);
  EXPECT_TRUE(track.is_taken_up());
}

TEST(SerialTrack, RefusesWhatItCannotKnow) {
  Track track(0, true, 0, 0, 10);
  track.add(5, 20, 20);
  expect_error(ErrorCode::bad_argument, [&] { track.during({5, 15}, 100); }, {"older"});
  expect_error(ErrorCode::bad_argument, [&] { track.during({15, 150}, 100); }, {"not over"});
  track.lose();
  expect_error(ErrorCode::unavailable, [&] { track.during({15, 50}, 100); }, {"not known"});
}

}  // namespace
}  // namespace fathom::test
