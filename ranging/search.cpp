// SPDX-License-Identifier: Apache-2.0
#include "ranging/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr double kLongPart = std::numbers::phi - 1;  // R of eq. 5-3: R^2 = 1 - R
constexpr double kShortPart = 1 - kLongPart;

}  // namespace

double SearchTrace::score_at(double wanted) {
  const double position = objective_.nearest(wanted);
  for (const Evaluation& known : evaluations_) {
    if (known.position == position) return known.score;
  }
  const double score = objective_.score(position);
  if (!std::isfinite(score)) {
    throw Error(ErrorCode::bad_data,
                fmt::format("the score at position {} is not a number", position));
  }
  evaluations_.push_back({static_cast<int>(evaluations_.size()) + 1, position, score});
  objective_.on_evaluation(evaluations_.back());
  return score;
}

const Evaluation& best_of(std::span<const Evaluation> evaluations) {
  if (evaluations.empty()) throw Error(ErrorCode::bad_argument, "no position was evaluated");
  return *std::max_element(
      evaluations.begin(), evaluations.end(),
      [](const Evaluation& a, const Evaluation& b) { return a.score < b.score; });
}

Bracket parse_bracket(std::string_view text) {
  double values[3] = {};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  bool good = true;
  for (int i = 0; i < 3 && good; ++i) {
    const auto [next, problem] = std::from_chars(at, end, values[i]);
    good = problem == std::errc() && (i == 2 ? next == end : next != end && *next == ',');
    if (good && i < 2) at = next + 1;
  }
  if (!good || !(values[0] < values[1] && values[1] < values[2])) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("\"{}\" is not a bracket; write A,X,B: three lens positions in increasing "
                    "order with the peak between A and B, such as 600,700,800",
                    text));
  }
  return {values[0], values[1], values[2]};
}

void golden_section(SearchTrace& trace, const Bracket& bracket, double tolerance) {
  if (!(tolerance > 0)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a search tolerance of {} never ends; it must be above 0", tolerance));
  }
  double low = bracket.low, high = bracket.high;
  double x1 = bracket.inner, x2 = bracket.inner;
  if (high - bracket.inner > bracket.inner - low) {
    x2 = bracket.inner + kShortPart * (high - bracket.inner);
  } else {
    x1 = bracket.inner - kShortPart * (bracket.inner - low);
  }
  double score1 = trace.score_at(x1);
  double score2 = trace.score_at(x2);
  // A tolerance below the spacing of doubles ends where the interval cannot be divided any more.
  while (high - low > tolerance && low < x1 && x1 < x2 && x2 < high) {
    if (score2 > score1) {
      low = x1;
      x1 = x2;
      score1 = score2;
      x2 = kLongPart * x1 + kShortPart * high;
      score2 = trace.score_at(x2);
    } else {
      high = x2;
      x2 = x1;
      score2 = score1;
      x1 = kLongPart * x2 + kShortPart * low;
      score1 = trace.score_at(x1);
    }
  }
}

void evaluate_all(SearchTrace& trace, std::span<const double> positions) {
  for (const double position : positions) trace.score_at(position);
}

Bracket bracket_around_best(std::span<const Evaluation> evaluations) {
  const double best = best_of(evaluations).position;
  double low = best, high = best;  // the neighbours, if there are any
  for (const Evaluation& e : evaluations) {
    if (e.position < best && (low == best || e.position > low)) low = e.position;
    if (e.position > best && (high == best || e.position < high)) high = e.position;
  }
  if (low == best) return {best, best + kShortPart * (high - best), high};
  if (high == best) return {low, best - kShortPart * (best - low), best};
  return {low, best, high};
}

}  // namespace fathom
