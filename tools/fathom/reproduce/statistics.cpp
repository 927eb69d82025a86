// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/error.hpp"
#include "focus/distributions.hpp"

namespace fathom::reproduce {

Summary summarise(std::span<const double> values) {
  Summary summary;
  if (values.empty()) return summary;
  const auto count = static_cast<double>(values.size());
  summary.count = static_cast<int>(values.size());
  for (const double value : values) summary.mean += value / count;
  double squares = 0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  if (values.size() > 1) summary.sd = std::sqrt(squares / (count - 1));
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  summary.least = *least;
  summary.most = *most;
  return summary;
}

double r_squared_of(std::span<const double> y, std::span<const double> fitted) {
  const double mean = summarise(y).mean;
  double about_fit = 0, about_mean = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    about_fit += (y[i] - fitted[i]) * (y[i] - fitted[i]);
    about_mean += (y[i] - mean) * (y[i] - mean);
  }
  return about_mean == 0 ? 0 : 1 - about_fit / about_mean;
}

Line fit_line(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) throw Error(ErrorCode::bad_argument, "a line needs an x for every y");
  const double x_mean = summarise(x).mean, y_mean = summarise(y).mean;
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - x_mean) * (x[i] - x_mean);
    xy += (x[i] - x_mean) * (y[i] - y_mean);
  }
  if (xx == 0) throw Error(ErrorCode::bad_argument, "a line needs two different x");
  Line line;
  line.slope = xy / xx;
  line.intercept = y_mean - line.slope * x_mean;
  std::vector<double> fitted;
  for (const double value : x) fitted.push_back(line.at(value));
  line.r_squared = r_squared_of(y, fitted);
  return line;
}

double roughness(std::span<const double> y) {
  if (y.size() < 3) return 0;
  double squares = 0;
  for (std::size_t i = 1; i + 1 < y.size(); ++i) {
    const double bend = y[i - 1] - 2 * y[i] + y[i + 1];
    squares += bend * bend / 6;
  }
  return std::sqrt(squares / static_cast<double>(y.size() - 2));
}

Ratio mean_ratio(std::span<const double> ratios) {
  std::vector<double> logarithms;
  for (const double ratio : ratios) logarithms.push_back(std::log(ratio));
  const Summary of_logs = summarise(logarithms);
  const double half = of_logs.count < 2 ? 0
                                        : student_t_within(0.95, of_logs.count - 1) * of_logs.sd /
                                              std::sqrt(of_logs.count);
  return {of_logs.count, std::exp(of_logs.mean), std::exp(of_logs.mean - half),
          std::exp(of_logs.mean + half)};
}

}  // namespace fathom::reproduce
