// SPDX-License-Identifier: Apache-2.0
// What the pictures are for: the focus curve peaks where the lens formula says, looks like the
// thesis' and repeats as the thesis' did.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "hal/drivers/simulated/thin_lens.hpp"
#include "simulated_support.hpp"

namespace fathom {
namespace {

using simulated::focused_distance_mm;
using simulated::focused_position_steps;
using test::SimulatedRig;

const char* const kMetrics[] = {"fft", "walsh-paley", "walsh-sequency"};

TEST(SimulatedFocus, PeaksWhereTheLensFormulaSaysAndFallsOffEitherWay) {
  // Rounding to 8 bits moves the score by this part of the peak, so a shoulder may be so uneven.
  constexpr double rounding = 1e-4;
  for (const char* metric : kMetrics) {
    for (const int distance_mm : {1400, 1800, 2600}) {
      SimulatedRig rig(fmt::format("sim:noise=0,distance={}", distance_mm), metric);
      const double focus = focused_position_steps(distance_mm);
      const int first = static_cast<int>(std::lround(focus)) - 60;
      std::vector<double> curve;
      for (int i = 0; i <= 120; ++i) curve.push_back(rig.score_at(first + i));
      const int peak =
          static_cast<int>(std::max_element(curve.begin(), curve.end()) - curve.begin());
      EXPECT_NEAR(first + peak, focus, 1) << metric << " at " << distance_mm << " mm";
      for (int i = 0; i < 120; ++i) {
        const double towards_peak = i < peak ? curve[i + 1] - curve[i] : curve[i] - curve[i + 1];
        EXPECT_GT(towards_peak, -rounding * curve[peak])
            << metric << " at " << distance_mm << " mm, position " << first + i;
      }
    }
  }
}

/// Distance to half the height of a focus curve, and its height 100 and some 300 steps away, as
/// parts of the peak.
struct Shape {
  double half_height_steps, slope, floor;
};

Shape measure_shape(SimulatedRig& rig, double distance_mm) {
  const double middle = std::round(focused_position_steps(distance_mm));
  std::map<int, double> curve;
  for (int offset = -42; offset <= 42; offset += 3) curve[offset] = rig.score_at(middle + offset);
  double peak = 0;
  for (const auto& [offset, score] : curve) peak = std::max(peak, score);
  int above_half = 0;
  for (const auto& [offset, score] : curve) above_half += score > peak / 2;
  const auto beside = [&](std::initializer_list<int> offsets) {
    double sum = 0;
    for (const int offset : offsets) sum += rig.score_at(middle + offset);
    return sum / static_cast<double>(offsets.size()) / peak;
  };
  // Samples are 3 steps apart, on two sides.
  return {above_half * 3 / 2.0, beside({-100, 100}), beside({-280, -300, -320})};
}

TEST(SimulatedFocus, SeedlingCurveIsLikeTheThesisTable) {
  for (const int distance_mm : {1500, 2500}) {
    const std::string text = fmt::format("sim:target=seedling,distance={}", distance_mm);
    SimulatedRig fft(text, "fft"), walsh(text, "walsh-sequency");
    const Shape fourier = measure_shape(fft, distance_mm);
    EXPECT_GE(fourier.half_height_steps, 18) << distance_mm;
    EXPECT_LE(fourier.half_height_steps, 30) << distance_mm;
    EXPECT_GT(fourier.floor, 0.08) << distance_mm;
    EXPECT_LT(fourier.floor, 0.18) << distance_mm;
    const Shape sequency = measure_shape(walsh, distance_mm);
    EXPECT_GE(sequency.half_height_steps, fourier.half_height_steps) << distance_mm;
    EXPECT_LE(sequency.half_height_steps, 38) << distance_mm;
    EXPECT_GT(sequency.floor, 0.08) << distance_mm;
    EXPECT_LT(sequency.floor, 0.13) << distance_mm;
    EXPECT_GT(sequency.slope / sequency.floor, fourier.slope / fourier.floor)
        << "the Walsh slope is felt farther away, " << distance_mm;
  }
}

TEST(SimulatedFocus, EveryCoarsePassMeetsThePeak) {
  for (const char* target : {"usaf", "seedling"}) {
    SimulatedRig rig(fmt::format("sim:target={},distance=2500", target));
    const double reach = rig.lens().info().coarse_spacing / 2;
    const double focus = std::round(focused_position_steps(2500));
    const double floor = rig.score_at(focus - 400);
    EXPECT_GT(rig.score_at(focus - reach), 1.25 * floor) << target;
    EXPECT_GT(rig.score_at(focus + reach), 1.25 * floor) << target;
  }
}

TEST(SimulatedFocus, NeedlesInFrontMakeTheSeedlingReadSlightlyNear) {
  for (const int distance_mm : {1500, 2500}) {
    SimulatedRig rig(fmt::format("sim:target=seedling,noise=0,distance={}", distance_mm));
    const int focus = static_cast<int>(focused_position_steps(distance_mm));
    int best = focus;
    for (int p = focus - 12; p <= focus + 12; ++p) {
      if (rig.score_at(p) > rig.score_at(best)) best = p;
    }
    const double near_by = 1 - focused_distance_mm(best) / distance_mm;
    EXPECT_GT(near_by, 0.001) << distance_mm;
    EXPECT_LT(near_by, 0.005) << distance_mm;
  }
}

TEST(SimulatedFocus, OrangeHasAWeakPeakAndABlankCardNone) {
  const auto contrast = [](const char* target) {
    SimulatedRig rig(fmt::format("sim:target={},distance=1864", target));
    const double focus = std::round(focused_position_steps(1864));
    double sharp = 0, blurred = 0;
    for (int i = 0; i < 10; ++i) {
      sharp += rig.score_at(focus - 4 + i);
      blurred += rig.score_at(focus - 300 + i);
    }
    return sharp / blurred;
  };
  EXPECT_GT(contrast("usaf"), 5);
  EXPECT_GT(contrast("orange"), 1.15);
  EXPECT_LT(contrast("orange"), 2);
  EXPECT_NEAR(contrast("blank"), 1, 0.03);
}

/// Half the range of the scores of 40 measurements over ten minutes, as a part of their middle.
double repeatability(SimulatedRig& rig, int frames) {
  const double focus = std::round(focused_position_steps(1800));
  double lowest = 1e300, highest = 0;
  for (int i = 0; i < 40; ++i) {
    rig.lens().move_to(focus - 180);  // 15 s there and back
    rig.lens().move_to(focus);
    const double score = rig.score(frames);
    lowest = std::min(lowest, score);
    highest = std::max(highest, score);
  }
  return (highest - lowest) / (highest + lowest);
}

TEST(SimulatedFocus, RepeatsAsTheThesisMeasured) {
  for (const char* metric : kMetrics) {
    SimulatedRig rig("sim:distance=1800", metric);
    const double one = repeatability(rig, 1), ten = repeatability(rig, 10);
    EXPECT_LT(one, 0.02) << metric;
    EXPECT_LT(ten, 0.015) << metric;
    EXPECT_GT(ten, 0.004) << metric << ": averaging must not remove the drift of the light";
  }
}

TEST(SimulatedFocus, AveragingRemovesTheRandomPart) {
  SimulatedRig rig("sim:distance=1800,drift=0");
  const double one = repeatability(rig, 1), ten = repeatability(rig, 10);
  EXPECT_GT(one, 0.004);
  EXPECT_LT(ten, one / 2);
}

/// Golden section (thesis T9) over a bracket that holds the peak, tolerance 2 steps: the best
/// position evaluated.
double golden_section(SimulatedRig& rig, double low, double high) {
  constexpr double ratio = 0.6180339887498949;
  double best = 0, best_score = 0;
  const auto evaluate = [&](double position) {
    const double score = rig.score_at(position);
    if (score > best_score) best = rig.lens().position();
    best_score = std::max(best_score, score);
    return score;
  };
  double left = high - ratio * (high - low), right = low + ratio * (high - low);
  double left_score = evaluate(left), right_score = evaluate(right);
  while (high - low > 2) {
    if (left_score < right_score) {
      low = std::exchange(left, right);
      left_score = right_score;
      right = low + ratio * (high - low);
      right_score = evaluate(right);
    } else {
      high = std::exchange(right, left);
      right_score = left_score;
      left = high - ratio * (high - low);
      left_score = evaluate(left);
    }
  }
  return best;
}

TEST(SimulatedFocus, GoldenSectionMeasuresDistancesBetterThanTheThesis) {
  for (const char* metric : {"fft", "walsh-sequency"}) {
    for (const char* target : {"usaf", "seedling"}) {
      SimulatedRig rig(fmt::format("sim:target={}", target), metric);
      std::vector<double> errors;
      for (int distance_mm = 1400; distance_mm <= 2600; distance_mm += 200) {
        rig.stage().place_at(distance_mm);
        // The bracket must not sit the same way round every peak.
        const double middle = focused_position_steps(distance_mm) + distance_mm * 7 % 61 - 30.0;
        const double best = golden_section(rig, middle - 100, std::min(middle + 100, double{1200}));
        errors.push_back(focused_distance_mm(best) / distance_mm - 1);
      }
      const double mean =
          std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
      // The seedling's mean is its needles; what calibration cannot remove is the scatter about it.
      const double allowed = std::string(target) == "usaf" ? 0.001 : 0.005;
      EXPECT_LT(std::abs(mean), allowed) << metric << ' ' << target;
      double scatter = 0;
      for (const double error : errors) scatter += std::abs(error - mean);
      EXPECT_LT(scatter / static_cast<double>(errors.size()), 0.003) << metric << ' ' << target;
    }
  }
}

}  // namespace
}  // namespace fathom
