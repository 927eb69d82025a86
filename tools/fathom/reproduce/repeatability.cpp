// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/repeatability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fathom::reproduce {
namespace {

void take_readings(Readings& readings, int count, const ShouldStop& should_stop) {
  RigChoice choice;
  choice.average = readings.average;
  choice.more = fmt::format(",distance={}", readings.distance_mm);
  ThreeScores rig(choice, should_stop);
  const double focus = std::round(true_position(readings.distance_mm));
  const double position = readings.far ? focus - kReadingsFar : focus;
  for (int i = 0; i < count; ++i) {
    // One FFT took the thesis 55 s, so a minute lay between two readings; here only the motor lets
    // time pass: away and back.
    constexpr double kAway = 600;
    rig.lens().move_to(position > kAway ? position - kAway : position + kAway);
    readings.scores.push_back(rig.at(position));
  }
}

}  // namespace

Summary Readings::of(std::size_t transform) const {
  std::vector<double> values;
  for (const ThreeNumbers& score : scores) values.push_back(score[transform]);
  return summarise(values);
}

const Readings& Repeatability::find(double distance_mm, bool far, int average) const {
  for (const Readings& r : readings) {
    if (r.distance_mm == distance_mm && r.far == far && r.average == average) return r;
  }
  throw std::out_of_range("no such readings");
}

double Repeatability::worst_half_range(std::size_t transform, int average) const {
  double worst = 0;
  for (const Readings& r : readings) {
    if (r.far || r.average != average) continue;
    worst = std::max(worst, r.of(transform).half_range_part());
  }
  return worst;
}

void plan_repeatability(Repeatability& repeatability, const Effort& effort,
                        const ShouldStop& should_stop, Tasks& tasks) {
  for (const double distance : kCurveDistances) {
    for (const bool far : {false, true}) {
      for (const int average : {1, kManyFrames}) {
        repeatability.readings.push_back({distance, far, average, {}});
      }
    }
  }
  for (Readings& readings : repeatability.readings) {
    tasks.emplace_back([&readings, count = effort.readings, should_stop] {
      take_readings(readings, count, should_stop);
    });
  }
}

}  // namespace fathom::reproduce
