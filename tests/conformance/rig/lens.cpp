// SPDX-License-Identifier: Apache-2.0
// What hal/lens.hpp promises, of every lens.
#include <algorithm>
#include <cmath>
#include <limits>

#include "fixtures.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

class LensConformance : public RigConformance {
 protected:
  /// A position at a share of the travel.
  double at(double share) {
    const LensInfo info = lens().info();
    return info.lowest + share * (info.highest - info.lowest);
  }

  /// Positions on the grid, off it, and at both ends.
  std::vector<double> places() {
    std::vector<double> positions;
    for (const double share : {0.5, 0.0, 0.123, 1.0, 0.98765, 0.3, 0.31, 0.02}) {
      positions.push_back(at(share));
    }
    return positions;
  }
};

TEST_P(LensConformance, KnowsWhatItIs) {
  const LensInfo info = lens().info();
  EXPECT_FALSE(info.description.empty());
  EXPECT_EQ(info.description.find('\n'), std::string::npos);
  EXPECT_FALSE(info.unit.empty());
  EXPECT_LT(info.lowest, info.highest);
  EXPECT_GT(info.resolution, 0);
  if (info.optics) {
    EXPECT_NO_THROW(optics::require_valid(*info.optics));
  }
  if (info.coarse_spacing != 0) {
    EXPECT_GE(info.coarse_spacing, info.resolution);
  }
  EXPECT_LE(info.coarse_spacing, info.highest - info.lowest);
  EXPECT_GE(lens().position(), info.lowest);
  EXPECT_LE(lens().position(), info.highest);
}

TEST_P(LensConformance, RefusesPositionsBeyondItsLimitsWithoutMoving) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const LensInfo info = lens().info();
  const double stood = lens().move_to(at(0.4)).position;
  for (const double position : {info.lowest - 1e-6, info.highest + 1e-6, info.lowest - 1e9,
                                info.highest + 1e9, kInfinity, -kInfinity}) {
    expect_error(ErrorCode::out_of_bounds, [&] { lens().move_to(position); });
    EXPECT_EQ(lens().position(), stood);
  }
  expect_error(ErrorCode::bad_argument,
               [&] { lens().move_to(std::numeric_limits<double>::quiet_NaN()); });
  EXPECT_EQ(lens().position(), stood);
}

TEST_P(LensConformance, ReachesBothLimits) {
  const LensInfo info = lens().info();
  EXPECT_EQ(lens().move_to(info.highest).position, info.highest);
  EXPECT_EQ(lens().move_to(info.lowest).position, info.lowest);
}

TEST_P(LensConformance, NearestForetellsWhereAMoveEnds) {
  for (const double position : places()) {
    const double foretold = lens().nearest(position);
    EXPECT_EQ(lens().nearest(foretold), foretold);
    const Arrival arrival = lens().move_to(position);
    EXPECT_EQ(arrival.position, foretold);
    EXPECT_EQ(lens().position(), foretold);
    if (std::abs(arrival.position - position) > lens().info().resolution) {
      EXPECT_FALSE(arrival.note.empty()) << "far from " << position << " without a word";
    }
  }
}

TEST_P(LensConformance, NearestStaysWithinTheLimits) {
  const LensInfo info = lens().info();
  EXPECT_EQ(lens().nearest(info.lowest - 1e6), info.lowest);
  EXPECT_EQ(lens().nearest(info.highest + 1e6), info.highest);
}

TEST_P(LensConformance, SettlesLaterAndLater) {
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
  for (const double position : places()) {
    const Arrival arrival = lens().move_to(position);
    EXPECT_GE(arrival.settled_ns, last_ns);
    last_ns = arrival.settled_ns;
  }
}

TEST_P(LensConformance, HomeIsTheLowestPosition) {
  lens().move_to(at(0.7));
  const Arrival arrival = lens().home();
  EXPECT_EQ(arrival.position, lens().info().lowest);
  EXPECT_EQ(lens().position(), lens().info().lowest);
}

TEST_P(LensConformance, OnePositionIsOnePlaceWhicheverWayItCame) {
  if (!GetParam().is_noiseless) GTEST_SKIP() << "noise hides which place it is";
  const double small = 2 * lens().info().resolution;
  for (const double share : {0.35, 0.0, 1.0, 0.01}) {
    const double place = lens().nearest(at(share));
    const auto pixels_from = [&](double start) {
      lens().move_to(std::clamp(start, at(0), at(1)));
      return pixels_of(grab_after(lens().move_to(place).settled_ns));
    };
    const auto pixels = pixels_from(at(0));
    EXPECT_EQ(pixels, pixels_from(at(1))) << "from above to " << place;
    EXPECT_EQ(pixels, pixels_from(place - small)) << "from just below to " << place;
    EXPECT_EQ(pixels, pixels_from(place + small)) << "from just above to " << place;
    lens().home();
    EXPECT_EQ(pixels, pixels_of(grab_after(lens().move_to(place).settled_ns))) << "from home";
  }
}

TEST_P(LensConformance, AnotherPlaceLooksDifferent) {
  if (!GetParam().is_noiseless) GTEST_SKIP() << "noise hides which place it is";
  const auto here = pixels_of(grab_after(lens().move_to(at(0.2)).settled_ns));
  const auto there = pixels_of(grab_after(lens().move_to(at(0.7)).settled_ns));
  EXPECT_NE(here, there);
}

TEST_P(LensConformance, CameraAndLensMayBeDestroyedInAnyOrder) {
  rig_.camera = nullptr;
  EXPECT_EQ(lens().move_to(lens().info().highest).position, lens().info().highest);
  rig_ = Hardware();  // what belongs to one at a time is given back before it is opened again
  rig_ = open();
  rig_.lens = nullptr;
  rig_.stage = nullptr;
  EXPECT_FALSE(grab().empty());
}

INSTANTIATE_TEST_SUITE_P(Rigs, LensConformance, testing::ValuesIn(rig_fixtures()), fixture_label);

}  // namespace
}  // namespace fathom::test
