// SPDX-License-Identifier: Apache-2.0
#include "focus/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/error.hpp"
#include "focus/light.hpp"

namespace fathom {
namespace {

constexpr double kLongPart = std::numbers::phi - 1;  // R of eq. 5-3: R^2 = 1 - R
constexpr double kShortPart = 1 - kLongPart;

void require_tolerance(double tolerance) {
  if (tolerance > 0) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("a search tolerance of {} never ends; it must be above 0", tolerance));
}

}  // namespace

double SearchTrace::score_at(double wanted) {
  const double position = objective_.nearest(wanted);
  for (const Evaluation& known : evaluations_) {
    if (known.position == position) return known.score;
  }
  return evaluations_.emplace_back(evaluate(position)).score;
}

const Evaluation& SearchTrace::look_again(double wanted) {
  return second_looks_.emplace_back(evaluate(objective_.nearest(wanted)));
}

Evaluation SearchTrace::evaluate(double position) {
  return taken(position, objective_.score(position));
}

Evaluation SearchTrace::taken(double position, const Sample& sample) const {
  if (!std::isfinite(sample.score)) {
    throw Error(ErrorCode::bad_data,
                fmt::format("the score at position {} is not a number", position));
  }
  const auto before = evaluations_.size() + second_looks_.size() + passed_.size();
  return {static_cast<int>(before) + 1, position, sample.score, sample.picture, sample.on_the_way};
}

void SearchTrace::travel(double wanted, double apart, const std::function<bool()>& goes_on) {
  objective_.travel(objective_.nearest(wanted), apart, [&](double position, const Sample& sample) {
    Evaluation e = taken(position, sample);
    if (!e.on_the_way) {
      evaluations_.push_back(std::move(e));
      return false;
    }
    passed_.push_back(std::move(e));
    return goes_on();
  });
}

std::vector<Evaluation> SearchTrace::seen() const {
  std::vector<Evaluation> seen = evaluations_;
  seen.insert(seen.end(), passed_.begin(), passed_.end());
  return seen;
}

bool SearchTrace::has(double wanted) const {
  const double position = objective_.nearest(wanted);
  return std::any_of(evaluations_.begin(), evaluations_.end(),
                     [&](const Evaluation& e) { return e.position == position; });
}

std::vector<Evaluation> SearchTrace::known() const {
  std::vector<Evaluation> known = background_;
  known.insert(known.end(), evaluations_.begin(), evaluations_.end());
  return known;
}

FocusCurve SearchTrace::curve() const { return FocusCurve(in_one_light(known(), light_)); }

FocusCurve SearchTrace::raw_curve() const { return FocusCurve(known()); }

std::vector<Evaluation> SearchTrace::second_looks() const {
  std::vector<Evaluation> all = known();
  const auto count = static_cast<std::ptrdiff_t>(all.size());
  all.insert(all.end(), second_looks_.begin(), second_looks_.end());
  all = in_one_light(std::move(all), light_);
  return {all.begin() + count, all.end()};
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
  require_tolerance(tolerance);
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

void fibonacci_section(SearchTrace& trace, double low, double high, double tolerance) {
  require_tolerance(tolerance);
  std::vector<double> numbers = {1, 1};
  constexpr std::size_t kMost = 75;  // beyond which their ratios differ no more in a double
  while (numbers.back() < (high - low) / tolerance && numbers.size() < kMost) {
    numbers.push_back(numbers.back() + numbers[numbers.size() - 2]);
  }
  if (numbers.size() < 3) {
    trace.score_at((low + high) / 2);
    return;
  }
  std::size_t n = numbers.size() - 1;
  double x1 = low + (high - low) * numbers[n - 2] / numbers[n];
  double x2 = low + (high - low) * numbers[n - 1] / numbers[n];
  double score1 = trace.score_at(x1), score2 = trace.score_at(x2);
  // At n = 2 both points would be the middle of what is left, where one stands already.
  for (--n; n >= 3; --n) {
    if (score2 > score1) {
      low = x1;
      x1 = x2;
      score1 = score2;
      x2 = low + (high - low) * numbers[n - 1] / numbers[n];
      score2 = trace.score_at(x2);
    } else {
      high = x2;
      x2 = x1;
      score2 = score1;
      x1 = low + (high - low) * numbers[n - 2] / numbers[n];
      score1 = trace.score_at(x1);
    }
  }
}

void brent(SearchTrace& trace, double low, double high, double tolerance) {
  require_tolerance(tolerance);
  // Boost's precision is relative to the position, in bits; ours is absolute, so positions are
  // shifted to lie between 1 and 2 lengths of the interval.
  const double length = high - low;
  if (!(length > 0)) {
    trace.score_at(low);
    return;
  }
  const double wanted = std::log2(4 * length / tolerance);
  constexpr int kMostBits = std::numeric_limits<double>::digits / 2;
  const int bits = static_cast<int>(std::clamp(std::ceil(wanted), 2.0, 1.0 * kMostBits));
  std::uintmax_t turns = 200;  // on whole steps it may turn on the spot
  boost::math::tools::brent_find_minima(
      [&](double x) { return -trace.score_at(low + (x - 1) * length); }, 1.0, 2.0, bits, turns);
}

void hill_climb(SearchTrace& trace, double start, double step, double low, double high,
                double tolerance) {
  require_tolerance(tolerance);
  double at = std::clamp(start, low, high), direction = 1;
  double score = trace.score_at(at);
  const auto leads_on = [&](double to) {
    return trace.nearest(std::clamp(to, low, high)) != trace.nearest(at);
  };
  // A tolerance below what the lens can tell ends where steps lead nowhere any more.
  while (step >= tolerance / 2 && (leads_on(at - step) || leads_on(at + step))) {
    bool climbed = false;
    for (int way = 0; way < 2 && !climbed; ++way, direction = -direction) {
      double next = std::clamp(at + direction * step, low, high);
      for (double higher; next != at && (higher = trace.score_at(next)) > score;
           next = std::clamp(at + direction * step, low, high)) {
        at = next;
        score = higher;
        climbed = true;
      }
    }
    step /= 2;
  }
}

void evaluate_all(SearchTrace& trace, std::span<const double> positions) {
  for (const double position : positions) trace.score_at(position);
}

Bracket whole_range(double low, double high) {
  return {low, low + kShortPart * (high - low), high};
}

Bracket bracket_around_best(std::span<const Evaluation> evaluations) {
  const double best = best_of(evaluations).position;
  double low = best, high = best;  // the neighbours, if there are any
  for (const Evaluation& e : evaluations) {
    if (e.position < best && (low == best || e.position > low)) low = e.position;
    if (e.position > best && (high == best || e.position < high)) high = e.position;
  }
  if (low == best) return whole_range(best, high);
  if (high == best) return {low, best - kShortPart * (best - low), best};
  return {low, best, high};
}

}  // namespace fathom
