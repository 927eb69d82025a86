// SPDX-License-Identifier: Apache-2.0
// Calibrates the simulated rig, maps its slanted chart, its stair and its ball, and holds the maps
// against the truth. What lies within a window of a cliff has no answer.
//
//   fathom_depth_rig [SEEDS]
//
// The answer is the root mean square of error over distance; at most 0.1 % is wanted.
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "backends/backends.hpp"
#include "calibration/calibration.hpp"
#include "depth/mapper.hpp"
#include "session/session.hpp"

namespace fathom {
namespace {

constexpr double kWantedPart = 0.001;
constexpr double kFrom = 850, kTo = 1050, kStep = 5;

RigOptions named(const std::string& rig) {
  RigOptions options;
  options.rig = rig;
  return options;
}

/// One search at each of some distances.
Calibration calibrated(int seed) {
  Rig rig(named(fmt::format("sim:target=usaf,seed={}", seed)));
  std::vector<CalibrationPoint> points;
  for (double distance_mm = 1300; distance_mm <= 1750; distance_mm += 50) {
    rig.stage()->place_at(distance_mm);
    Observers nobody({});
    const Run run = Session(rig).focus(FocusRequest(), nobody);
    if (run.focus->result() != FocusResult::focused) continue;
    points.push_back({.position = run.focus->position(), .distance_mm = distance_mm});
  }
  return Calibration::fit(CalibrationModel::thin_lens, points, {});
}

/// Adds each picture of a sweep to a map.
class Mapping final : public Observer {
 public:
  explicit Mapping(DepthMapper& mapper) : mapper_(mapper) {}
  void frame(const Frame& frame, const Arrival&, std::span<const double>) override {
    mapper_.add(next_++, frame);
  }

 private:
  DepthMapper& mapper_;
  std::size_t next_ = 0;
};

DepthMaps mapped(Rig& rig) {
  std::vector<double> positions;
  for (double position = kFrom; position <= kTo; position += kStep) positions.push_back(position);
  const auto open = [](const MetricSpec& spec, std::size_t windows) {
    return select_device(all_backends(), "cpu", spec, windows);
  };
  const CameraSettings picture = rig.camera().settings();
  DepthMapper mapper(open, picture.width_px, picture.height_px, positions, {.blur = rig.blur()});
  Mapping mapping(mapper);
  Session(rig).visit(positions, mapping);
  return mapper.finish();
}

/// Root mean square of error over distance, where there is an answer, and how often there is one.
struct Truth {
  double error = 0;
  double answered = 0;
};

Truth held_against(const DepthMaps& maps, const Calibration& calibration,
                   const TargetStage& stage) {
  double squares = 0, known = 0;
  for (std::size_t i = 0; i < maps.position.size(); ++i) {
    if (maps.classes[i] != DepthClass::known) continue;
    const auto [y, x] = std::div(static_cast<int>(i), maps.width_px);
    const double truth = stage.distance_mm(x, y);
    squares += std::pow(calibration.distance_mm(maps.position[i]) / truth - 1, 2);
    ++known;
  }
  return {std::sqrt(squares / known), known / static_cast<double>(maps.position.size())};
}

int run(int seeds) {
  bool holds = true;
  fmt::print("target  seed  error/distance  answered\n");
  for (const char* const target : {"slant", "stair", "sphere"}) {
    for (int seed = 1; seed <= seeds; ++seed) {
      Rig rig(named(fmt::format("sim:target={},distance=1500,seed={}", target, seed)));
      const Truth truth = held_against(mapped(rig), calibrated(seed), *rig.stage());
      fmt::print("{:6}  {:4}  {:12.4f} %  {:6.1f} %\n", target, seed, 100 * truth.error,
                 100 * truth.answered);
      holds = holds && truth.error <= kWantedPart;
    }
  }
  fmt::print("wanted: at most {} %: {}\n", 100 * kWantedPart, holds ? "holds" : "missed");
  return holds ? 0 : 1;
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) {
  constexpr int kUsualSeeds = 5;
  const int seeds = argc > 1 ? std::atoi(argv[1]) : kUsualSeeds;
  if (seeds < 1) {
    fmt::print(stderr, "fathom_depth_rig [SEEDS]: 1 or more\n");
    return 2;
  }
  return fathom::run(seeds);
}
