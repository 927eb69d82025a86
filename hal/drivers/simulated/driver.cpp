// SPDX-License-Identifier: Apache-2.0
// The driver "sim": the thesis' rig, with honest optics, noise and mechanics.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "engine/error.hpp"
#include "hal/drivers/simulated/lens.hpp"
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

  Hardware open(const RigSettings& settings, const OpenOptions& options) const override {
    const auto world = std::make_shared<World>(world_settings(settings));
    return {std::make_unique<SimulatedCamera>(world),
            std::make_unique<SimulatedLens>(world, options.stop_requests),
            std::make_unique<SimulatedStage>(world)};
  }
};

}  // namespace

const RigDriver& sim_driver() {
  static const SimulatedDriver driver;
  return driver;
}

}  // namespace fathom
