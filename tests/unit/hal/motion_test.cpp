// SPDX-License-Identifier: Apache-2.0
#include "hal/motion.hpp"

#include <gtest/gtest.h>

#include "hal/lens.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

class PlainLens : public Lens {
 public:
  LensInfo info() const override { return {"plain lens", "steps", 0, 100, 1, 10, {}}; }
  double position() const override { return 0; }
  Arrival move_to(double) override { return {}; }
  Arrival home() override { return {}; }
};

class ShyLens final : public PlainLens {
 public:
  std::string why_unwatched() const override { return "it is shy"; }
};

class WatchedLens final : public PlainLens {
 public:
  std::string why_unwatched() const override { return {}; }
};

/// Gives what it was asked for.
class EchoingMotion final : public Motion {
 public:
  void stop() override {}
  std::optional<Arrival> arrived() override { return std::nullopt; }
  Arrival wait() override { return {}; }

 private:
  Where do_during(const Exposure& exposure) const override {
    return {.position = static_cast<double>(exposure.start_ns),
            .sigma = 0,
            .smear = static_cast<double>(exposure.end_ns - exposure.start_ns)};
  }
};

TEST(Motion, ALensThatCannotBeWatchedSaysSoInItsOwnWords) {
  PlainLens plain;
  ShyLens shy;
  EXPECT_FALSE(plain.can_be_watched());
  EXPECT_FALSE(shy.can_be_watched());
  EXPECT_TRUE(WatchedLens().can_be_watched());
  expect_error(ErrorCode::unsupported, [&] { plain.start(5); }, {"plain lens", "only at rest"});
  expect_error(ErrorCode::unsupported, [&] { shy.start(5); }, {"plain lens", "it is shy"});
}

TEST(Motion, RefusesExposuresThatMeanNothing) {
  const EchoingMotion motion;
  expect_error(ErrorCode::bad_argument, [&] { motion.during({}); }, {"nobody stamped"});
  expect_error(ErrorCode::bad_argument, [&] { motion.during({7, 6}); }, {"7 to 6"});
  EXPECT_EQ(motion.during({7, 9}).smear, 2);
  EXPECT_EQ(motion.during({0, 9}).smear, 9) << "a clock may begin at 0";
  EXPECT_EQ(motion.at(0).position, 0) << "and a moment is no stamp";
}

}  // namespace
}  // namespace fathom
