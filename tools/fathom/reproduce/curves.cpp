// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace fathom::reproduce {
namespace {

constexpr int kLastStep = 1200;
constexpr double kNearSteps = 60;  ///< Round the focus a curve is sampled every two steps.
constexpr int kFineStep = 2;

std::vector<double> positions_round(double focus, int step) {
  std::set<double> positions;
  for (int p = 0; p <= kLastStep; p += step) positions.insert(p);
  const int middle = static_cast<int>(std::lround(focus));
  const int reach = static_cast<int>(kNearSteps);
  for (int p = middle - reach; p <= middle + reach; p += kFineStep) positions.insert(p);
  return {positions.begin(), positions.end()};
}

RigChoice chart_at(double distance_mm) {
  RigChoice choice;
  choice.more = fmt::format(",distance={}", distance_mm);
  return choice;
}

/// Relative scatter of a score far from focus, as the repeatability section measures it.
constexpr double kScatter = 0.01;

void measure_curve(MeasuredCurves& curve, int step, const ShouldStop& should_stop) {
  ThreeScores rig(chart_at(curve.distance_mm), should_stop);
  curve.truth = true_position(curve.distance_mm);
  curve.positions = positions_round(curve.truth, step);
  for (const double position : curve.positions) curve.scores.push_back(rig.at(position));
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    std::vector<Evaluation> evaluations;
    for (std::size_t i = 0; i < curve.positions.size(); ++i) {
      evaluations.push_back({static_cast<int>(i) + 1, curve.positions[i], curve.scores[i][t]});
    }
    const double top = best_of(evaluations).score;
    curve.best[t] = best_of(evaluations).position;
    const FocusLimits limits = resolve_limits({}, rig.lens().info());
    SearchTrace seen({});
    seen.remember(evaluations);
    const Focus focus =
        judge_search(seen, limits, {MetricSpec::parse(kTransforms[t].metric), kScatter});
    curve.fitted[t] = focus.peak.position;
    curve.lobes[t] = focus.lobes.size();
    for (ThreeNumbers& scores : curve.scores) scores[t] /= top;
  }
}

/// The samples on either side of the focus are stretches of their own.
void add_stretch(ThreeScores& rig, double from, double to, std::vector<ThreeNumbers>& stretch) {
  for (double p = from; p <= to; p += kFarStep) stretch.push_back(rig.at(p));
}

std::vector<double> column(const std::vector<ThreeNumbers>& rows, std::size_t t, double unit) {
  std::vector<double> values;
  for (const ThreeNumbers& row : rows) values.push_back(row[t] / unit);
  return values;
}

void measure_floor(FarFloor& floor, std::uint64_t seed, const ShouldStop& should_stop) {
  RigChoice choice = chart_at(floor.distance_mm);
  choice.target = floor.target;
  choice.seed = seed;
  ThreeScores rig(choice, should_stop);
  const double truth = true_position(floor.distance_mm);
  std::vector<ThreeNumbers> below, above;
  add_stretch(rig, 0, truth - kFarSteps, below);
  ThreeNumbers peak{};
  // The seedling's needles focus a few steps beyond its stem, so the peak is looked for.
  for (double p = std::round(truth) - 4; p <= truth + 16; p += 2) {
    const ThreeNumbers scores = rig.at(p);
    for (std::size_t t = 0; t < kTransformCount; ++t) peak[t] = std::max(peak[t], scores[t]);
  }
  add_stretch(rig, std::ceil(truth + kFarSteps), kLastStep, above);
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const auto low = column(below, t, peak[t]), high = column(above, t, peak[t]);
    std::vector<double> all = low;
    all.insert(all.end(), high.begin(), high.end());
    const double low_rough = roughness(low), high_rough = roughness(high);
    const double low_part =
        static_cast<double>(low.size()) / static_cast<double>(low.size() + high.size());
    floor.level[t] = summarise(all).mean;
    floor.of_peak[t] =
        std::sqrt(low_part * low_rough * low_rough + (1 - low_part) * high_rough * high_rough);
    floor.of_level[t] = floor.of_peak[t] / floor.level[t];
  }
}

Ratio ratio_of(const std::vector<FarFloor>& floors, ThreeNumbers FarFloor::*which, std::size_t t) {
  std::vector<double> ratios;
  for (const FarFloor& floor : floors) ratios.push_back((floor.*which)[kFft] / (floor.*which)[t]);
  return mean_ratio(ratios);
}

}  // namespace

void plan_curves(Curves& curves, const Effort& effort, const ShouldStop& should_stop,
                 Tasks& tasks) {
  for (const double distance : kCurveDistances) {
    curves.curves.push_back({distance, 0, {}, {}, {}, {}, {}});
  }
  for (const char* const target : {"usaf", "seedling"}) {
    for (const double distance : kCurveDistances) {
      if (effort.quick && !curves.floors.empty()) break;
      for (int i = 0; i < effort.far_seeds; ++i) {
        curves.floors.push_back({target, distance, {}, {}, {}});
      }
    }
  }
  for (MeasuredCurves& curve : curves.curves) {
    tasks.emplace_back([&curve, step = effort.curve_step, should_stop] {
      measure_curve(curve, step, should_stop);
    });
  }
  for (std::size_t i = 0; i < curves.floors.size(); ++i) {
    tasks.emplace_back([&floor = curves.floors[i], i, should_stop] {
      measure_floor(floor, kSeed + i, should_stop);
    });
  }
}

void finish_curves(Curves& curves) {
  curves.paley_of_peak = ratio_of(curves.floors, &FarFloor::of_peak, kPaley);
  curves.sequency_of_peak = ratio_of(curves.floors, &FarFloor::of_peak, kSequency);
  curves.paley_of_level = ratio_of(curves.floors, &FarFloor::of_level, kPaley);
  curves.sequency_of_level = ratio_of(curves.floors, &FarFloor::of_level, kSequency);
}

}  // namespace fathom::reproduce
