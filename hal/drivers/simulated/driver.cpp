// SPDX-License-Identifier: Apache-2.0
// The driver "sim": the thesis' rig, with honest optics, noise and mechanics.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/drivers/simulated/lens.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"
#include "hal/drivers/simulated/world.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace {

using namespace simulated;

constexpr double kShortestExposureMs = 1;
constexpr double kLongestExposureMs = 1000;
// Whatever stands before the target stays far beyond the focal length.
constexpr double kSteepestMm = 3;
constexpr double kHighestStepMm = 200;
constexpr int kMostSteps = 8;
constexpr double kLargestRadiusMm = 1000;

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
    return adjust(wished, possible);
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

  void skip_until(std::int64_t time_ns) override { world_->skip_until(time_ns); }

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

  double distance_mm(double x_px, double y_px) const override {
    return world_->distance_mm(x_px, y_px);
  }

  void place_at(double distance_mm) override {
    const Objective& objective = world_->objective();
    if (!(distance_mm >= objective.nearest_target_mm &&
          distance_mm <= objective.farthest_target_mm)) {
      throw Error(
          ErrorCode::out_of_bounds,
          fmt::format("the simulated stage reaches {} to {} mm, not {} mm",
                      objective.nearest_target_mm, objective.farthest_target_mm, distance_mm));
    }
    world_->set_distance_mm(distance_mm);
  }

 private:
  std::shared_ptr<World> world_;
};

constexpr std::string_view kOptics[] = {"told", "untold"};

/// The keys of one target alone are not known for the others.
ReliefShape relief_shape(const RigSettings& settings, Target target) {
  ReliefShape shape;
  if (target == Target::slant)
    shape.slope_mm = settings.number("slope", shape.slope_mm, -kSteepestMm, kSteepestMm);
  if (target == Target::stair) {
    shape.step_mm = settings.number("step", shape.step_mm, 0, kHighestStepMm);
    shape.steps = static_cast<int>(settings.integer("steps", shape.steps, 2, kMostSteps));
  }
  if (target == Target::sphere)
    shape.radius_mm = settings.number("radius", shape.radius_mm, 1, kLargestRadiusMm);
  if (is_relief(target)) shape.breathes = settings.flag("breathing", shape.breathes);
  return shape;
}

const Objective& objective_of(const RigSettings& settings) {
  static constexpr std::string_view kNames[] = {"thesis", "webcam"};
  return settings.choice("lens", "thesis", kNames) == "webcam" ? webcam_objective()
                                                               : thesis_objective();
}

/// Reliefs are drawn by the geometry of the thesis' lens alone.
void require_drawable(const RigSettings& settings, const WorldSettings& rig) {
  if (!is_relief(rig.target) || rig.objective == &thesis_objective()) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("{}: target={} needs lens=thesis; of lens={} there are usaf, seedling, "
                          "orange and blank",
                          settings.where(), kTargetNames[static_cast<std::size_t>(rig.target)],
                          rig.objective->name));
}

WorldSettings world_settings(const RigSettings& settings) {
  WorldSettings rig;
  const Objective& objective = *(rig.objective = &objective_of(settings));
  const std::string target = settings.choice("target", "usaf", kTargetNames);
  const auto* const name = std::find(std::begin(kTargetNames), std::end(kTargetNames), target);
  rig.target = static_cast<Target>(name - std::begin(kTargetNames));
  rig.relief = relief_shape(settings, rig.target);
  rig.distance_mm = settings.number("distance", objective.usual_distance_mm,
                                    objective.nearest_target_mm, objective.farthest_target_mm);
  rig.f_number = settings.number("fnumber", objective.usual_f_number,
                                 std::min(2.8, objective.usual_f_number), 32);
  rig.exposure_ms =
      settings.number("exposure_ms", rig.exposure_ms, kShortestExposureMs, kLongestExposureMs);
  rig.seed = static_cast<std::uint64_t>(
      settings.integer("seed", static_cast<long long>(rig.seed), 0, 999'999'999'999));
  rig.noise = settings.number("noise", rig.noise, 0, 100);
  rig.drift = settings.number("drift", rig.noise, 0, 50);
  rig.start_steps =
      static_cast<int>(settings.integer("start", rig.start_steps, 0, objective.travel));
  rig.backlash_steps = static_cast<int>(settings.integer("backlash", objective.play, 0, 100));
  rig.rate_steps_per_s = settings.number("rate", objective.rate_per_s, 1, 1000);
  rig.speed_mm_per_s = settings.number("speed", rig.speed_mm_per_s, -1000, 1000);
  rig.lose_steps = static_cast<int>(settings.integer("lose", rig.lose_steps, 0, objective.travel));
  rig.tells_optics = settings.choice("optics", std::string(kOptics[0]), kOptics) == kOptics[0];
  require_drawable(settings, rig);
  return rig;
}

class SimulatedDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "sim"; }

  const char* summary() const noexcept override {
    return "the simulated thesis rig: target=usaf|seedling|orange|blank|slant|stair|sphere, "
           "distance=MM, seed=N, "
           "noise=X and drift=X (1 is normal), fnumber=N, exposure_ms=MS, start=STEPS, "
           "backlash=STEPS, rate=STEPS_PER_S, lose=STEPS (in the next long move), speed=MM_PER_S "
           "(of the target, away), optics=told|untold (untold: as lenses that say nothing of "
           "themselves); of slant slope=MM_PER_PX, of stair step=MM and steps=N, of sphere "
           "radius=MM, "
           "of these three breathing=true (the picture grows with the lens); lens=webcam: a small "
           "camera for arm's length, 0 to 255 in steps of focusing power";
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
