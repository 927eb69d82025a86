// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/comparison.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"
#include "engine/optics.hpp"
#include "session/session.hpp"

namespace fathom {
namespace {

/// One place where all contenders are put.
struct Scene {
  std::string target;
  double distance_mm, noise, start;
  int seed;
};

std::vector<Scene> list(const ComparisonScenes& scenes) {
  std::vector<Scene> all;
  for (const std::string& target : scenes.targets) {
    for (const double distance_mm : scenes.distances_mm) {
      for (const double noise : scenes.noises) {
        for (const double start : scenes.starts) {
          for (int seed = 1; seed <= scenes.seeds; ++seed)
            all.push_back({.target = target,
                           .distance_mm = distance_mm,
                           .noise = noise,
                           .start = start,
                           .seed = seed});
        }
      }
    }
  }
  return all;
}

std::unique_ptr<Rig> open(const std::string& rig, RigOptions options) {
  options.rig = rig;
  return std::make_unique<Rig>(options);
}

/// Positions to distances on this target: what its shape does to the focus is in the curve.
Calibration calibrate(const std::string& target, const RigOptions& options) {
  const auto rig = open(fmt::format("sim:target={},noise=0,drift=0", target), options);
  Observer nobody;
  std::vector<CalibrationPoint> points;
  for (double distance_mm = 1400; distance_mm <= 2600; distance_mm += 200) {
    rig->stage()->place_at(distance_mm);
    const Focus focus = *Session(*rig).focus({}, nobody).focus;
    if (focus.result() == FocusResult::focused) points.push_back({focus.position(), distance_mm});
  }
  return Calibration::fit(CalibrationModel::inverse, std::move(points), {});
}

Focus search(Rig& rig, const Contender& contender, const Scene& scene) {
  const LensInfo lens = rig.lens().info();
  FocusRequest request;
  request.search = contender.search;
  request.peak = contender.peak;
  request.start = scene.start;
  if (contender.is_bare) request.bracket = whole_range(lens.lowest, lens.highest);
  Observer nobody;
  return *Session(rig).focus(request, nobody).focus;
}

double travel(double start, const std::vector<Evaluation>& evaluations) {
  double sum = 0, at = start;
  for (const Evaluation& e : evaluations) {
    sum += std::abs(e.position - at);
    at = e.position;
  }
  return sum;
}

void judge_run(SearchTally& tally, const Focus& focus, const Scene& scene,
               const Calibration& calibration, const LensInfo& lens) {
  ++tally.runs;
  tally.evaluations.push_back(static_cast<double>(focus.evaluations.size()));
  tally.moved_steps.push_back(travel(scene.start, focus.evaluations));
  const bool is_answer = focus.result() == FocusResult::focused;
  const double error_mm = std::abs(calibration.distance_mm(focus.position()) - scene.distance_mm);
  const double half_depth_mm =
      optics::depth_of_field(lens.optics.value(), scene.distance_mm).total_mm() / 2;
  if (!(error_mm < half_depth_mm)) {
    ++tally.trapped;
    if (is_answer) ++tally.wrong;
    return;
  }
  if (!is_answer) {
    ++tally.declined;
    return;
  }
  ++tally.right;
  tally.errors_percent.push_back(100 * error_mm / scene.distance_mm);
}

}  // namespace

std::vector<Contender> all_contenders() {
  using enum SearchMethod;
  constexpr auto kThesis = PeakMethod::evaluated;
  return {{"golden, bare (thesis)", golden, kThesis, true},
          {"golden, bracket found (thesis)", golden, kThesis, false},
          {"golden, bracket found, fit", golden, PeakMethod::fit, false},
          {"fibonacci, bare", fibonacci, kThesis, true},
          {"fibonacci, bracket found, fit", fibonacci, PeakMethod::fit, false},
          {"brent, bare", brent, kThesis, true},
          {"brent, bracket found, fit", brent, PeakMethod::fit, false},
          {"hill", hill, PeakMethod::fit, false},
          {"full", full, PeakMethod::fit, false},
          {"coarse", coarse, PeakMethod::fit, false},
          {"spectral", spectral, PeakMethod::fit, false},
          {"auto", automatic, PeakMethod::fit, false}};
}

std::vector<SearchTally> compare_searches(const std::vector<Contender>& contenders,
                                          const ComparisonScenes& scenes, const RigOptions& options,
                                          const std::function<void(std::size_t done)>& told) {
  std::vector<SearchTally> tallies;
  for (const Contender& contender : contenders) tallies.push_back({.contender = contender});
  std::optional<Calibration> calibration;
  std::string calibrated;
  std::size_t done = 0;
  for (const Scene& scene : list(scenes)) {
    if (!calibration || calibrated != scene.target) {
      calibration = calibrate(scene.target, options);
      calibrated = scene.target;
    }
    const std::string text =
        fmt::format("sim:target={},distance={},noise={},start={},seed={}", scene.target,
                    scene.distance_mm, scene.noise, scene.start, scene.seed);
    for (SearchTally& tally : tallies) {
      const auto rig = open(text, options);
      const Focus focus = search(*rig, tally.contender, scene);
      judge_run(tally, focus, scene, *calibration, rig->lens().info());
      told(++done);
    }
  }
  return tallies;
}

}  // namespace fathom
