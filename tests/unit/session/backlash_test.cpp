// SPDX-License-Identifier: Apache-2.0
#include "session/backlash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fathom {
namespace {

/// A lens with play that it does not take up: going down it stands that much higher than it says.
struct Play {
  double counter = 50, place = 50, play = 0;
  std::int64_t clock_ns = 0;
};

class PlayingLens final : public Lens {
 public:
  explicit PlayingLens(std::shared_ptr<Play> state) : state_(std::move(state)) {}
  LensInfo info() const override { return {"lens with play", "steps", 0, 200, 1, 10, {}}; }
  double position() const override { return state_->counter; }
  Arrival move_to(double wanted) override {
    require_within(info(), wanted);
    state_->counter = nearest(wanted);
    state_->place = std::clamp(state_->place, state_->counter, state_->counter + state_->play);
    state_->clock_ns += 1000;
    return {.position = state_->counter,
            .started_ns = state_->clock_ns - 900,
            .stopped_ns = state_->clock_ns,
            .settled_ns = state_->clock_ns};
  }
  Arrival home() override { return move_to(0); }

 private:
  std::shared_ptr<Play> state_;
};

class PlayingCamera final : public Camera {
 public:
  explicit PlayingCamera(std::shared_ptr<Play> state) : state_(std::move(state)) {}
  std::string description() const override { return "camera"; }
  CameraSettings settings() const override { return {32, 32, Depth::bits16, 1}; }
  Validity validate(CameraSettings&) const override { return Validity::valid; }
  void apply(const CameraSettings&) override {}
  bool is_live() const override { return true; }
  std::optional<Frame> grab(std::chrono::milliseconds) override {
    const double z = (state_->place - 100) / 9;
    const double stripes = 3000 * std::exp(-z * z / 2) + 200;
    std::vector<std::uint16_t> pixels(32 * 32);
    for (int i = 0; i < 32 * 32; ++i) {
      const double chance = std::sin(12.9898 * (i + static_cast<double>(state_->clock_ns)));
      pixels[i] =
          static_cast<std::uint16_t>(20000 + (i / 2 % 2 == 0 ? stripes : -stripes) + 60 * chance);
    }
    state_->clock_ns += 10;
    Frame frame(32, 32, std::move(pixels));
    frame.exposure = {state_->clock_ns, state_->clock_ns + 5};
    return frame;
  }

 private:
  std::shared_ptr<Play> state_;
};

Backlash measured(double play) {
  auto state = std::make_shared<Play>();
  state->play = play;
  Hardware hardware{std::make_unique<PlayingCamera>(state), std::make_unique<PlayingLens>(state),
                    nullptr};
  RigOptions options;
  options.rig = "test";
  options.metric = "fft:32";
  Rig rig(options, std::move(hardware));
  return measure_backlash(rig, 100, 25, 0, 0);
}

TEST(Backlash, IsTheShiftBetweenTheWays) {
  for (const double play : {3.0, 7.0, 12.0}) {
    const Backlash backlash = measured(play);
    EXPECT_NEAR(backlash.play(), play, 0.3);
    EXPECT_TRUE(backlash.is_certain());
    EXPECT_GE(backlash.suggestion(1), play - 0.3);
    EXPECT_LE(backlash.suggestion(1), play + 3);
  }
}

TEST(Backlash, OfALensWithoutPlayIsNone) {
  const Backlash backlash = measured(0);
  EXPECT_NEAR(backlash.play(), 0, 0.3);
  EXPECT_EQ(backlash.suggestion(1), 0);
}

TEST(Backlash, IsTakenUpByTheSimulatedLens) {
  RigOptions options;
  options.rig = "sim:backlash=12,noise=0.5,drift=0";
  Rig rig(options);
  EXPECT_EQ(measure_backlash(rig, 781, 40, 0, 0).suggestion(1), 0);
}

}  // namespace
}  // namespace fathom
