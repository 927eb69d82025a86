// SPDX-License-Identifier: Apache-2.0
#include "calibration/choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "engine/error.hpp"
#include "engine/quantile.hpp"

namespace fathom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Which fold each point is left out with.
std::vector<int> folds_of(std::span<const CalibrationPoint> points) {
  constexpr int kMostFolds = 20;
  std::map<double, int> order;
  for (const CalibrationPoint& point : points) order[point.distance_mm] = 0;
  int next = 0;
  for (auto& [distance, fold] : order) fold = next++ % kMostFolds;
  std::vector<int> folds;
  for (const CalibrationPoint& point : points) folds.push_back(order[point.distance_mm]);
  return folds;
}

/// Relative error of the prediction of each point by the rest without its outliers; infinite where
/// that gives no curve.
std::vector<double> predict(CalibrationModel model, std::span<const CalibrationPoint> points,
                            const std::vector<int>& folds, const std::vector<bool>& outlier) {
  std::vector<double> errors(points.size(), kInfinity);
  for (const int fold : std::set<int>(folds.begin(), folds.end())) {
    std::vector<CalibrationPoint> rest;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (folds[i] != fold && !outlier[i]) rest.push_back(points[i]);
    }
    try {
      const auto fit = Calibration::fit(model, std::move(rest), {});
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (folds[i] != fold) continue;
        const double error =
            std::abs(fit.distance_mm(points[i].position) / points[i].distance_mm - 1);
        if (std::isfinite(error)) errors[i] = error;
      }
    } catch (const Error&) {  // Then it predicts nothing, which is what the errors say.
    }
  }
  return errors;
}

/// A trial with what it was judged by.
struct Candidate {
  ModelTrial trial;
  std::vector<double> errors;
  std::vector<bool> left_out;
};

Candidate try_model(CalibrationModel model, std::span<const CalibrationPoint> points,
                    const std::vector<int>& folds) {
  Candidate candidate{{model, kInfinity, std::nan(""), ""},
                      std::vector<double>(points.size(), kInfinity),
                      std::vector<bool>(points.size(), false)};
  try {
    const auto fit = Calibration::fit(model, {points.begin(), points.end()}, {});
    candidate.trial.r_squared = fit.r_squared();
    for (std::size_t i = 0; i < points.size(); ++i) candidate.left_out[i] = fit.left_out(i);
    candidate.errors = predict(model, points, folds, std::vector<bool>(points.size(), false));
  } catch (const Error& error) {
    candidate.trial.problem = error.what();
  }
  return candidate;
}

/// The outliers by the candidate that most points fit best: a curve that does not fit knows none.
std::vector<bool> outliers_of(const std::vector<Candidate>& candidates) {
  return std::min_element(candidates.begin(), candidates.end(),
                          [](const Candidate& a, const Candidate& b) {
                            return median(a.errors) < median(b.errors);
                          })
      ->left_out;
}

/// A fold's fit has fewer points to know an outlier by than all of them: it is told.
void predict_again(std::vector<Candidate>& candidates, std::span<const CalibrationPoint> points,
                   const std::vector<int>& folds, const std::vector<bool>& outlier) {
  if (std::find(outlier.begin(), outlier.end(), true) == outlier.end()) return;
  for (Candidate& candidate : candidates) {
    if (candidate.trial.problem.empty())
      candidate.errors = predict(candidate.trial.model, points, folds, outlier);
  }
}

/// Mean squared error of each fold, without outliers.
std::vector<double> fold_squares(const Candidate& candidate, const std::vector<int>& folds,
                                 const std::vector<bool>& outlier) {
  std::map<int, std::pair<double, int>> sums;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    if (outlier[i]) continue;
    auto& [sum, count] = sums[folds[i]];
    sum += candidate.errors[i] * candidate.errors[i];
    ++count;
  }
  std::vector<double> squares;
  for (const auto& [fold, sum] : sums) squares.push_back(sum.first / sum.second);
  return squares;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Whether `better` may just have been lucky, fold by fold.
bool within_one_standard_error(const std::vector<double>& better,
                               const std::vector<double>& other) {
  std::vector<double> lead;
  for (std::size_t i = 0; i < better.size(); ++i) lead.push_back(other[i] - better[i]);
  const double mean = mean_of(lead), n = static_cast<double>(lead.size());
  double squares = 0;
  for (const double value : lead) squares += (value - mean) * (value - mean);
  return mean <= std::sqrt(squares / (n - 1) / n);
}

std::size_t lowest_error(const std::vector<ModelTrial>& trials) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < trials.size(); ++i) {
    if (trials[i].error < trials[best].error) best = i;
  }
  return best;
}

/// The best of those with fewer parameters that may be as good, else the best itself.
std::size_t simplest_as_good(const std::vector<ModelTrial>& trials,
                             const std::vector<std::vector<double>>& squares, std::size_t best) {
  constexpr double kNoDifference = 0.05, kRounding = 1e-9;
  const double near = trials[best].error * (1 + kNoDifference) + kRounding;
  std::size_t winner = best;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const bool simpler = parameter_count(trials[i].model) < parameter_count(trials[best].model);
    const bool as_good =
        trials[i].error <= near || within_one_standard_error(squares[best], squares[i]);
    if (simpler && as_good && (winner == best || trials[i].error < trials[winner].error)) {
      winner = i;
    }
  }
  return winner;
}

std::vector<Candidate> try_all(std::span<const CalibrationPoint> points,
                               const std::vector<int>& folds) {
  std::vector<Candidate> candidates;
  for (const CalibrationModel model : calibration_models()) {
    candidates.push_back(try_model(model, points, folds));
  }
  return candidates;
}

}  // namespace

ModelChoice choose_calibration_model(std::span<const CalibrationPoint> points) {
  for (const CalibrationPoint& point : points) {  // What is no number has no order either.
    if (!std::isfinite(point.distance_mm) || !std::isfinite(point.position)) {
      throw Error(ErrorCode::bad_argument, "a calibration point is not a number");
    }
  }
  const std::vector<int> folds = folds_of(points);
  if (std::set<int>(folds.begin(), folds.end()).size() < 3) {
    throw Error(
        ErrorCode::bad_argument,
        "choosing a model needs 3 distances or more, so that one can be left out; better 8");
  }
  std::vector<Candidate> candidates = try_all(points, folds);
  const std::vector<bool> outlier = outliers_of(candidates);
  predict_again(candidates, points, folds, outlier);
  ModelChoice choice;
  std::vector<std::vector<double>> squares;
  for (Candidate& candidate : candidates) {
    squares.push_back(fold_squares(candidate, folds, outlier));
    candidate.trial.error = std::sqrt(mean_of(squares.back()));
    if (std::isinf(candidate.trial.error) && candidate.trial.problem.empty()) {
      candidate.trial.problem = "without one of the distances it has no curve";
    }
    choice.trials.push_back(candidate.trial);
  }
  const std::size_t best = lowest_error(choice.trials);
  if (std::isinf(choice.trials[best].error)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("no model fits these points: {}", choice.trials[best].problem));
  }
  const std::size_t winner = simplest_as_good(choice.trials, squares, best);
  choice.best = choice.trials[best].model;
  choice.model = choice.trials[winner].model;
  return choice;
}

}  // namespace fathom
