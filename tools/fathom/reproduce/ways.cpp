// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/ways.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::reproduce {
namespace {

constexpr double kStepsPerSecond = 25;

std::vector<double> noises(const Effort& effort) {
  if (effort.quick) return {1, 24, 96};
  return {1, 4, 8, 16, 24, 32, 48, 64, 96};
}

/// Where a run begins, all by one number: the same for every way.
struct Scene {
  double distance_mm = 0;
  int start = 0;
  std::uint64_t seed = 0;
};

Scene scene_of(std::uint64_t number, double within) {
  Dice dice(number);
  Scene scene{.distance_mm = dice.between(kNearest, kFarthest)};
  const double focus = true_position(scene.distance_mm);
  const double low = std::max(0.0, focus - within);
  const double high = std::min(double{simulated::kTravelSteps}, focus + within);
  scene.start = static_cast<int>(dice.between(low, high));
  scene.seed = static_cast<std::uint64_t>(dice.below(1000000));
  return scene;
}

RigChoice rig_of(const Scene& scene, double noise, const char* target = "usaf") {
  RigChoice choice;
  choice.target = target;
  choice.seed = scene.seed;
  choice.more = fmt::format(",start={},noise={}", scene.start, noise);
  return choice;
}

FocusRequest request_for(SearchMethod search) {
  FocusRequest request;
  request.search = search;
  return request;
}

FocusRequest with_frames(int frames) {
  FocusRequest request;
  request.frames = frames;
  return request;
}

void plan_way(Way& way, int count, const FocusRequest& request, double within,
              const ShouldStop& should_stop, Tasks& tasks) {
  const OneRun one = [=](int i) {
    const Scene scene = scene_of(30000 + static_cast<std::uint64_t>(i), within);
    return run_on(rig_of(scene, 1), scene.distance_mm, request, should_stop);
  };
  add_runs(way.trial, count, one, tasks);
}

void plan_golden(Way& way, int count, const ShouldStop& should_stop, Tasks& tasks) {
  const OneRun one = [=](int i) {
    const Scene scene = scene_of(30000 + static_cast<std::uint64_t>(i), simulated::kTravelSteps);
    Dice dice(31000 + static_cast<std::uint64_t>(i));
    return run_on(rig_of(scene, 1), scene.distance_mm, thesis_request(scene.distance_mm, dice),
                  should_stop);
  };
  add_runs(way.trial, count, one, tasks);
}

void plan_noise(Ways& ways, const Effort& effort, const ShouldStop& should_stop, Tasks& tasks) {
  const int count = effort.noise_runs;
  const std::vector<double> levels = noises(effort);
  for (const double times : levels) {
    ways.noise.push_back(
        {.times = times, .coarse = {.name = "coarse pass"}, .spectral = {.name = "by spectra"}});
  }
  for (NoiseLevel& level : ways.noise) {
    const auto plan = [&](Trial& trial, SearchMethod search) {
      const OneRun one = [=, times = level.times](int i) {
        const Scene scene =
            scene_of(32000 + static_cast<std::uint64_t>(i), simulated::kTravelSteps);
        return run_on(rig_of(scene, times), scene.distance_mm, request_for(search), should_stop);
      };
      add_runs(trial, count, one, tasks);
    };
    plan(level.coarse, SearchMethod::coarse);
    plan(level.spectral, SearchMethod::spectral);
  }
  const OneRun blank = [=](int i) {
    const Scene scene = scene_of(33000 + static_cast<std::uint64_t>(i), simulated::kTravelSteps);
    const double times = levels[static_cast<std::size_t>(i) % levels.size()];
    return run_on(rig_of(scene, times, "blank"), scene.distance_mm,
                  request_for(SearchMethod::spectral), should_stop);
  };
  add_runs(ways.blank, count * static_cast<int>(levels.size()) / 4 + 1, blank, tasks);
}

void finish_way(Way& way, const Calibrations& calibrations) {
  finish_trial(way.trial, calibrations);
  const Calibration& calibration = *calibrations[way.trial.transform].own;
  std::vector<double> travel, seconds, frames;
  double all_travel = 0, all_direct = 0, squares = 0, parts = 0;
  for (const FocusRun& run : way.trial.runs) {
    const double focus = true_position(run.distance_mm);
    travel.push_back(run.travel);
    seconds.push_back(run.rig_seconds);
    frames.push_back(run.frames);
    all_travel += run.travel;
    all_direct += std::abs(focus - run.start);
    if (way.trial.judged && !run.focused()) continue;
    const double mm = calibration.distance_mm(run.position);
    way.close += std::abs(mm / run.distance_mm - 1) <= 0.005;
    squares += std::pow(run.position - focus, 2);
    parts += std::pow((run.position - focus) / run.sigma, 2);
  }
  const double count = static_cast<double>(way.trial.runs.size()), answers = way.trial.answers;
  way.travel = summarise(travel);
  way.rig_seconds = summarise(seconds);
  way.frames = summarise(frames);
  way.times_direct = all_travel / all_direct;
  way.allowed_s = 1.5 * all_direct / count / kStepsPerSecond + 3;
  way.off_steps = answers > 0 ? std::sqrt(squares / answers) : 0;
  way.off_in_sigmas = answers > 0 ? std::sqrt(parts / answers) : 0;
}

}  // namespace

double NoiseLevel::decibels() const { return 20 * std::log10(times); }

int right_of(const Trial& trial) { return trial.answers - trial.wrong; }

double noise_stood(const Ways& ways, Trial NoiseLevel::*trial) {
  double stood = -1;
  for (const NoiseLevel& level : ways.noise) {
    const Trial& one = level.*trial;
    if (10 * right_of(one) < 9 * static_cast<int>(one.runs.size())) break;
    stood = level.decibels();
  }
  return stood;
}

const NoiseLevel& level_at(const Ways& ways, double times) {
  return *std::find_if(ways.noise.begin(), ways.noise.end(),
                       [&](const NoiseLevel& level) { return level.times >= times; });
}

void plan_ways(Ways& ways, const Effort& effort, const ShouldStop& should_stop, Tasks& tasks) {
  ways.golden.trial = {.name = "golden section, the thesis' way", .judged = false};
  ways.coarse.trial = {.name = "coarse pass and fit"};
  ways.spectral.trial = {.name = "by spectra, Fathom's own way"};
  ways.three_frames.trial = {.name = "three frames, from anywhere"};
  ways.three_near.trial = {.name = "three frames, from within 200 steps"};
  ways.blank = {.name = "blank card"};
  constexpr double kAnywhere = simulated::kTravelSteps;
  const int count = effort.way_runs;
  plan_golden(ways.golden, count, should_stop, tasks);
  plan_way(ways.coarse, count, request_for(SearchMethod::coarse), kAnywhere, should_stop, tasks);
  plan_way(ways.spectral, count, request_for(SearchMethod::spectral), kAnywhere, should_stop,
           tasks);
  plan_way(ways.three_frames, count, with_frames(3), kAnywhere, should_stop, tasks);
  plan_way(ways.three_near, count, with_frames(3), kNear, should_stop, tasks);
  plan_noise(ways, effort, should_stop, tasks);
}

void finish_ways(Ways& ways, const Calibrations& calibrations) {
  for (Way* way :
       {&ways.golden, &ways.coarse, &ways.spectral, &ways.three_frames, &ways.three_near})
    finish_way(*way, calibrations);
  for (NoiseLevel& level : ways.noise) {
    finish_trial(level.coarse, calibrations);
    finish_trial(level.spectral, calibrations);
  }
  finish_trial(ways.blank, calibrations);
}

}  // namespace fathom::reproduce
