// SPDX-License-Identifier: Apache-2.0
#include "calibration/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "focus/least_squares.hpp"

namespace fathom {
namespace {

using Subset = std::array<std::size_t, CalibrationCurve::kMostParameters>;

constexpr double kMostSubsets = 2000;

/// Moves to the next combination of `size` indices below n in order; false after the last.
bool next_combination(Subset& subset, int size, std::size_t n) {
  int i = size - 1;
  while (i >= 0 && subset[i] == n - static_cast<std::size_t>(size - i)) --i;
  if (i < 0) return false;
  ++subset[i];
  for (int j = i + 1; j < size; ++j) subset[j] = subset[j - 1] + 1;
  return true;
}

double combinations(std::size_t n, int size) {
  double count = 1;
  for (int i = 0; i < size; ++i) count *= static_cast<double>(n - i) / (i + 1);
  return count;
}

/// Every subset while they are few, else a fixed sample: enough of them hold no outlier.
std::vector<Subset> subsets_of(std::size_t n, int size) {
  std::vector<Subset> subsets;
  if (combinations(n, size) <= kMostSubsets) {
    Subset subset = {0, 1, 2};
    do subsets.push_back(subset);
    while (next_combination(subset, size, n));
    return subsets;
  }
  // Of a clean three quarters 200 still hold some 84 clean ones, so many points cost less than all.
  constexpr double kFewestSubsets = 200, kEvaluations = 1e6;
  const double count =
      std::clamp(kEvaluations / static_cast<double>(n), kFewestSubsets, kMostSubsets);
  std::mt19937_64 random(1984);  // NOLINT: fixed, so that a fit is the same twice.
  while (static_cast<double>(subsets.size()) < count) {
    Subset subset = {};
    for (int i = 0; i < size; ++i) subset[i] = random() % n;
    subsets.push_back(subset);
  }
  return subsets;
}

double residual(const CalibrationCurve& curve, const CalibrationPoint& point) {
  const double off = std::abs(point.position - curve.position_for(point.distance_mm));
  return std::isnan(off) ? std::numeric_limits<double>::infinity() : off;
}

/// The residual that just over half of the points stay within, if curves are to go through
/// `parameters` of them (Rousseeuw and Leroy 1987, p. 125).
double median_residual(const CalibrationCurve& curve, std::span<const CalibrationPoint> points) {
  std::vector<double> residuals;
  for (const CalibrationPoint& point : points) residuals.push_back(residual(curve, point));
  const std::size_t half = points.size() / 2 + (curve.size() + 1) / 2;
  const auto median = residuals.begin() + static_cast<std::ptrdiff_t>(half - 1);
  std::nth_element(residuals.begin(), median, residuals.end());
  return *median;
}

struct LeastMedian {
  CalibrationCurve::Vector b;
  double residual;
};

std::optional<LeastMedian> least_median(CalibrationCurve curve,
                                        std::span<const CalibrationPoint> points) {
  std::optional<LeastMedian> best;
  std::array<CalibrationPoint, CalibrationCurve::kMostParameters> chosen;
  for (const Subset& subset : subsets_of(points.size(), curve.size())) {
    for (int i = 0; i < curve.size(); ++i) chosen[i] = points[subset[i]];
    const auto b = linear_start(curve, {chosen.data(), static_cast<std::size_t>(curve.size())});
    if (!b) continue;
    curve.set(*b);
    const double median = median_residual(curve, points);
    if (std::isfinite(median) && (!best || median < best->residual)) {
      best = LeastMedian{*b, median};
    }
  }
  return best;
}

}  // namespace

std::optional<CalibrationCurve::Vector> linear_start(const CalibrationCurve& shape,
                                                     std::span<const CalibrationPoint> points) {
  const auto size = static_cast<std::size_t>(shape.size());
  Matrix rows(points.size(), size);
  std::vector<double> values(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CalibrationCurve::LinearRow row = shape.linear_row(points[i]);
    for (std::size_t j = 0; j < size; ++j) rows(i, j) = row.row[j];
    values[i] = row.value;
  }
  const auto solved = solve_squares(rows, values);
  if (!solved) return std::nullopt;
  CalibrationCurve::Vector x = {};
  std::copy(solved->begin(), solved->end(), x.begin());
  return shape.from_linear(x);
}

double smallest_scatter(std::span<const CalibrationPoint> points) {
  bool whole = true;
  double largest = 0;
  for (const CalibrationPoint& point : points) {
    whole = whole && point.position == std::round(point.position);
    largest = std::max(largest, std::abs(point.position));
  }
  constexpr double kArithmetic = 1e-10;
  return std::max(whole ? 1 / std::sqrt(12.0) : 0, kArithmetic * largest);
}

std::vector<CalibrationPoint> without(std::span<const CalibrationPoint> points,
                                      const std::vector<bool>& left_out) {
  std::vector<CalibrationPoint> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!left_out[i]) kept.push_back(points[i]);
  }
  return kept;
}

Suspects find_suspects(const CalibrationCurve& shape, std::span<const CalibrationPoint> points) {
  constexpr double kSigmas = 5, kGaussian = 1.4826;
  const std::size_t n = points.size();
  const std::vector<bool> none(n, false);
  const auto spare = static_cast<double>(n) - shape.size();
  if (spare < 3) return {none, std::nullopt};
  const auto best = least_median(shape, points);
  if (!best) return {none, std::nullopt};
  const double sigma =
      std::max(kGaussian * (1 + 5 / spare) * best->residual, smallest_scatter(points));
  CalibrationCurve curve = shape;
  curve.set(best->b);
  std::vector<bool> outlier = none;
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    outlier[i] = residual(curve, points[i]) > kSigmas * sigma;
    count += outlier[i] ? 1 : 0;
  }
  // So many are no accidents: the curve is the wrong one, and its residuals must show it.
  if (4 * count > n) outlier = none;
  // What is left must still hold enough distances for a curve.
  if (count > 0 && !linear_start(shape, without(points, outlier))) outlier = none;
  return {std::move(outlier), best->b};
}

}  // namespace fathom
