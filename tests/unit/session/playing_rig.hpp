// SPDX-License-Identifier: Apache-2.0
// A rig whose lens has play, or says that it has arrived while its motor still runs, in a time of
// its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "session/rig.hpp"

namespace fathom::test {

/// A motor, the glass that it turns, and the clock. Focus is at 500 of 0 to 1000.
struct Gears {
  double play = 0;           ///< Going down the glass stands that much higher than the motor.
  double units_per_s = 1e9;  ///< Of the motor, whatever its driver says.
  bool says_when = true;     ///< Whether the driver waits until the motor is there.
  double light = 1;          ///< Of the camera's pictures.
  double counter = 300, motor = 300, glass = 300;
  std::int64_t clock_ns = 0;

  void run_to(std::int64_t time_ns) {
    const double most = units_per_s * 1e-9 * static_cast<double>(time_ns - clock_ns);
    motor += std::clamp(counter - motor, -most, most);
    glass = std::clamp(glass, motor, motor + play);
    clock_ns = time_ns;
  }
};

class PlayingLens final : public Lens {
 public:
  explicit PlayingLens(std::shared_ptr<Gears> gears) : gears_(std::move(gears)) {}
  LensInfo info() const override { return {"lens with play", "steps", 0, 1000, 1, 0, {}}; }
  double position() const override { return gears_->counter; }
  Arrival move_to(double wanted) override {
    require_within(info(), wanted);
    const std::int64_t started_ns = gears_->clock_ns;
    gears_->counter = nearest(wanted);
    const double way_s = std::abs(gears_->counter - gears_->motor) / gears_->units_per_s;
    gears_->run_to(started_ns + 1000 +
                   (gears_->says_when ? static_cast<std::int64_t>(std::ceil(way_s * 1e9)) : 0));
    return {.position = gears_->counter,
            .started_ns = started_ns,
            .stopped_ns = gears_->clock_ns,
            .settled_ns = gears_->clock_ns};
  }
  Arrival home() override { return move_to(0); }

 private:
  std::shared_ptr<Gears> gears_;
};

/// Thirty pictures a second, of stripes that fade away from the focus.
class PlayingCamera final : public Camera {
 public:
  explicit PlayingCamera(std::shared_ptr<Gears> gears) : gears_(std::move(gears)) {}
  std::string description() const override { return "camera"; }
  CameraSettings settings() const override { return {64, 64, Depth::bits16, 10}; }
  Validity validate(CameraSettings&) const override { return Validity::valid; }
  void apply(const CameraSettings&) override {}
  bool is_live() const override { return true; }
  std::optional<Frame> grab(std::chrono::milliseconds) override {
    const std::int64_t start_ns = gears_->clock_ns + 23'000'000;
    gears_->run_to(start_ns + 5'000'000);
    const double z = (gears_->glass - 500) / 12;
    const double stripes = 3000 * std::exp(-z * z / 2) + 200;
    std::vector<std::uint16_t> pixels(64 * 64);
    for (int i = 0; i < 64 * 64; ++i) {
      const double grey = 20000 + (i / 2 % 2 == 0 ? stripes : -stripes) + chance();
      pixels[i] = static_cast<std::uint16_t>(gears_->light * grey);
    }
    gears_->run_to(start_ns + 10'000'000);
    Frame frame(64, 64, std::move(pixels));
    frame.exposure = {start_ns, gears_->clock_ns};
    return frame;
  }

 private:
  std::shared_ptr<Gears> gears_;

  /// Of a linear congruential generator (Knuth's MMIX), -60 to 60.
  double chance() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return 120 * (static_cast<double>(state_ >> 40) / (1 << 24) - 0.5);
  }

  std::uint64_t state_ = 1;
};

inline Rig playing_rig(const std::shared_ptr<Gears>& gears, const std::string& metric = "fft:32") {
  RigOptions options;
  options.rig = "test";
  options.metric = metric;
  options.backend = "cpu";
  return Rig(options, {std::make_unique<PlayingCamera>(gears), std::make_unique<PlayingLens>(gears),
                       nullptr});
}

}  // namespace fathom::test
