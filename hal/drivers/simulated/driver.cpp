// SPDX-License-Identifier: Apache-2.0
// The driver "sim": the thesis' rig, with honest optics, noise and mechanics.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"
#include "hal/drivers/simulated/world.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace {

using namespace simulated;

constexpr double kShortestExposureMs = 1;
constexpr double kLongestExposureMs = 1000;

class SimulatedCamera final : public Camera {
 public:
  explicit SimulatedCamera(std::shared_ptr<World> world) : world_(std::move(world)) {}

  std::string description() const override {
    return fmt::format("simulated {} x {} px camera", kWidthPx, kHeightPx);
  }

  CameraSettings settings() const override {
    return {kWidthPx, kHeightPx, Depth::bits8, world_->settings().exposure_ms};
  }

  Validity validate(CameraSettings& wished) const override {
    if (wished.width_px <= 0 || wished.height_px <= 0 || !(wished.exposure_ms > 0)) {
      return Validity::refused;
    }
    const double exposure_ms =
        std::clamp(wished.exposure_ms, kShortestExposureMs, kLongestExposureMs);
    const CameraSettings possible{kWidthPx, kHeightPx, Depth::bits8, exposure_ms};
    if (wished == possible) return Validity::valid;
    wished = possible;
    return Validity::adjusted;
  }

  void apply(const CameraSettings& settings) override {
    CameraSettings checked = settings;
    if (validate(checked) != Validity::valid) {
      throw Error(
          ErrorCode::unsupported,
          fmt::format("the simulated camera takes {} x {} px, 8 bit, {} to {} ms; ask for those",
                      kWidthPx, kHeightPx, kShortestExposureMs, kLongestExposureMs));
    }
    world_->set_exposure_ms(settings.exposure_ms);
  }

  bool is_live() const override { return true; }

  std::optional<Frame> grab(std::chrono::milliseconds timeout) override {
    return world_->grab(timeout);
  }

 private:
  std::shared_ptr<World> world_;
};

class SimulatedLens final : public Lens {
 public:
  explicit SimulatedLens(std::shared_ptr<World> world) : world_(std::move(world)) {}

  LensInfo info() const override {
    const WorldSettings& rig = world_->settings();
    LensInfo info;
    info.description =
        fmt::format("simulated {} mm lens at f/{}, backlash {} steps, {} steps/s", kFocalLengthMm,
                    rig.f_number, rig.backlash_steps, rig.rate_steps_per_s);
    info.unit = "steps";
    info.lowest = 0;
    info.highest = kTravelSteps;
    info.resolution = 1;
    // A sample at most 56 steps from best focus at f/4 stands clearly above the floor; the disc of
    // confusion is the same at more steps for a smaller aperture.
    info.coarse_spacing = std::min(std::round(28 * rig.f_number), kTravelSteps / 4.0);
    info.optics = Optics{kFocalLengthMm, rig.f_number, kPitchMm};
    return info;
  }

  double position() const override { return world_->motor().counter(); }

  Arrival move_to(double position) override {
    require_within(info(), position);
    const int target = static_cast<int>(nearest(position));
    const int play = world_->settings().backlash_steps;
    const std::int64_t started_ns = world_->now_ns();
    // Below 0 the stop holds the lens while the motor still turns through the play, so even
    // position 0 is approached upward and the lens stands where the counter says.
    for (const int steps : approach_moves(world_->motor().counter(), target, play, -play)) {
      world_->step(steps);
    }
    return settled(started_ns);
  }

  Arrival home() override {
    const std::int64_t started_ns = world_->now_ns();
    const int play = world_->settings().backlash_steps;
    // Too fast a motor does not make all its steps, wherever the lens is: push on until it must be
    // there.
    const double followed = std::min(kStallRate / world_->motor().rate(), 1.0);
    world_->step(-static_cast<int>(std::ceil(1.5 * (kTravelSteps + play) / followed)));
    world_->set_counter(-play);
    world_->step(play);
    return settled(started_ns);
  }

 private:
  Arrival settled(std::int64_t started_ns) {
    const std::int64_t stopped_ns = world_->now_ns();
    world_->settle();
    return {position(), world_->now_ns(), "", started_ns, stopped_ns};
  }

  std::shared_ptr<World> world_;
};

class SimulatedStage final : public TargetStage {
 public:
  explicit SimulatedStage(std::shared_ptr<World> world) : world_(std::move(world)) {}

  double distance_mm() const override { return world_->distance_mm(); }

  void place_at(double distance_mm) override {
    if (!(distance_mm >= kNearestTargetMm && distance_mm <= kFarthestTargetMm)) {
      throw Error(ErrorCode::out_of_bounds,
                  fmt::format("the simulated stage reaches {} to {} mm, not {} mm",
                              kNearestTargetMm, kFarthestTargetMm, distance_mm));
    }
    world_->set_distance_mm(distance_mm);
  }

 private:
  std::shared_ptr<World> world_;
};

WorldSettings world_settings(const RigSettings& settings) {
  WorldSettings rig;
  const std::string target = settings.choice("target", "usaf", kTargetNames);
  const auto* const name = std::find(std::begin(kTargetNames), std::end(kTargetNames), target);
  rig.target = static_cast<Target>(name - std::begin(kTargetNames));
  rig.distance_mm =
      settings.number("distance", rig.distance_mm, kNearestTargetMm, kFarthestTargetMm);
  rig.f_number = settings.number("fnumber", rig.f_number, 2.8, 32);
  rig.exposure_ms =
      settings.number("exposure_ms", rig.exposure_ms, kShortestExposureMs, kLongestExposureMs);
  rig.seed = static_cast<std::uint64_t>(
      settings.integer("seed", static_cast<long long>(rig.seed), 0, 999'999'999'999));
  rig.noise = settings.number("noise", rig.noise, 0, 100);
  rig.drift = settings.number("drift", rig.noise, 0, 50);
  rig.start_steps = static_cast<int>(settings.integer("start", rig.start_steps, 0, kTravelSteps));
  rig.backlash_steps = static_cast<int>(settings.integer("backlash", rig.backlash_steps, 0, 100));
  rig.rate_steps_per_s = settings.number("rate", rig.rate_steps_per_s, 1, 1000);
  rig.speed_mm_per_s = settings.number("speed", rig.speed_mm_per_s, -1000, 1000);
  rig.lose_steps = static_cast<int>(settings.integer("lose", rig.lose_steps, 0, kTravelSteps));
  return rig;
}

class SimulatedDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "sim"; }

  const char* summary() const noexcept override {
    return "the simulated thesis rig: target=usaf|seedling|orange|blank, distance=MM, seed=N, "
           "noise=X and drift=X (1 is normal), fnumber=N, exposure_ms=MS, start=STEPS, "
           "backlash=STEPS, rate=STEPS_PER_S, lose=STEPS (in the next long move), speed=MM_PER_S "
           "(of the target, away)";
  }

  Hardware open(const RigSettings& settings, const OpenOptions&) const override {
    const auto world = std::make_shared<World>(world_settings(settings));
    return {std::make_unique<SimulatedCamera>(world), std::make_unique<SimulatedLens>(world),
            std::make_unique<SimulatedStage>(world)};
  }
};

}  // namespace

const RigDriver& sim_driver() {
  static const SimulatedDriver driver;
  return driver;
}

}  // namespace fathom
