// SPDX-License-Identifier: Apache-2.0
#include "bench/honesty/thesis_rig.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/optics.hpp"
#include "session/rig.hpp"

namespace fathom::honesty {

double pick(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
}

double steps_of(double distance_mm) { return 1200.0 * 1084 / (distance_mm - 135); }

double half_depth_in_steps(double distance_mm) {
  constexpr Optics kLens{135, 4, 0.04};
  const double half = optics::depth_of_field(kLens, distance_mm).total_mm() / 2;
  return std::abs(steps_of(distance_mm + half) - steps_of(distance_mm - half)) / 2;
}

double sharpest(const std::string& text, const std::string& metric,
                const std::optional<Window>& window, double distance_mm) {
  RigOptions options;
  options.rig = text + ",noise=0,drift=0,backlash=0";
  options.metric = metric;
  options.window = window;
  Rig rig(options);
  const double middle = std::round(steps_of(distance_mm));
  std::vector<double> scores;
  constexpr int kStep = 4, kFar = 3;
  for (int i = -kFar; i <= kFar; ++i) {
    const double position = std::clamp(middle + kStep * i, 0.0, 1200.0);
    scores.push_back(rig.bare_score(shoot(rig.camera(), rig.lens(), position, {}).frame));
  }
  // The top of a parabola through the best and its neighbours.
  const auto best = std::max_element(scores.begin() + 1, scores.end() - 1) - scores.begin();
  const double left = scores[best - 1], right = scores[best + 1];
  const double bend = left - 2 * scores[best] + right;
  const double beside = bend < 0 ? (left - right) / (2 * bend) : 0;
  return middle + kStep * (static_cast<double>(best) - kFar + beside);
}

}  // namespace fathom::honesty
