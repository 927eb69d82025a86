// SPDX-License-Identifier: Apache-2.0
#include "mapping/depth_result.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/quantile.hpp"

namespace fathom::mapping {
namespace {

/// Every so many-th pixel, so that a sum over a map costs nothing.
constexpr std::size_t kSampled = 200'000;

double quantile_of(const std::vector<float>& values, double part) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : quantile(values, part);
}

/// A calibration's curve in a table, because a map asks it millions of times.
class CurveTable {
 public:
  explicit CurveTable(const Calibration& calibration)
      : low_(calibration.lowest_position()),
        step_((calibration.highest_position() - low_) / kSteps) {
    for (int i = 0; i <= kSteps; ++i) {
      const double position = low_ + i * step_;
      rows_.push_back({calibration.distance_mm(position), std::abs(calibration.slope_mm(position)),
                       calibration.distance(position, 0).sigma_mm});
    }
  }

  struct Row {
    double mm, slope, fit_sigma_mm;
  };
  std::optional<Row> at(double position) const {
    const double place = (position - low_) / step_;
    if (!(place >= 0 && place <= kSteps)) return std::nullopt;
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(place), kSteps - 1);
    const double t = place - static_cast<double>(i);
    const auto mix = [t](double a, double b) { return a + t * (b - a); };
    const Row &a = rows_[i], &b = rows_[i + 1];
    return Row{mix(a.mm, b.mm), mix(a.slope, b.slope), mix(a.fit_sigma_mm, b.fit_sigma_mm)};
  }

 private:
  static constexpr int kSteps = 8192;
  double low_, step_;
  std::vector<Row> rows_;
};

}  // namespace

DepthSummary summary_of(const DepthMaps& maps) {
  DepthSummary summary;
  std::vector<float> depths, sigmas;
  float nearest = std::numeric_limits<float>::infinity(), farthest = -nearest;
  const std::size_t every = std::max<std::size_t>(1, maps.classes.size() / kSampled);
  for (std::size_t i = 0; i < maps.classes.size(); ++i) {
    ++summary.counts[static_cast<std::size_t>(maps.classes[i])];
    const float depth = maps.position[i];
    if (std::isnan(depth)) continue;
    ++summary.numbers;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
    if (summary.numbers % every != 0) continue;
    depths.push_back(depth);
    sigmas.push_back(maps.sigma[i]);
  }
  constexpr double kRim = 0.02;
  summary.low = quantile_of(depths, kRim);
  summary.high = quantile_of(depths, 1 - kRim);
  summary.median_sigma = quantile_of(sigmas, 0.5);
  summary.nearest = nearest;
  summary.farthest = farthest;
  return summary;
}

void make_metric(DepthMaps& maps, const Calibration& calibration) {
  const CurveTable table(calibration);
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < maps.position.size(); ++i) {
    if (std::isnan(maps.position[i])) continue;
    const auto row = table.at(maps.position[i]);
    if (!row || !std::isfinite(row->mm)) {
      maps.position[i] = maps.sigma[i] = maps.confidence[i] = kNone;
      maps.classes[i] = DepthClass::outside;
      continue;
    }
    maps.position[i] = static_cast<float>(row->mm);
    maps.sigma[i] = static_cast<float>(std::hypot(row->slope * maps.sigma[i], row->fit_sigma_mm));
  }
}

}  // namespace fathom::mapping
