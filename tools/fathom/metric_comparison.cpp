// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/metric_comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// Multiples of the pictures' noise that are tried, one after the other.
constexpr double kMultiples[] = {1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128};
/// Noises of one strength, and how many of them an answer must stand.
constexpr int kSeeds = 10, kMostLost = 1;

template <class Value>
std::vector<double> values_of(const std::vector<MethodTally>& methods, const Value& value) {
  std::vector<double> values;
  for (const MethodTally& method : methods) {
    if (method.answer.stands_out && !method.answer.is_at_end) values.push_back(value(method));
  }
  return values;
}

/// Of those that have a curve.
std::vector<double> widths_of(const std::vector<MethodTally>& methods) {
  std::vector<double> widths =
      values_of(methods, [](const auto& m) { return 2 * m.answer.peak.half_width; });
  std::erase(widths, 0);
  return widths;
}

/// The middle one, or the mean of the middle two. There is one value at least.
double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// Distance of the two pictures round a position.
double spacing_at(const std::vector<double>& positions, double at) {
  std::vector<double> sorted = positions;
  std::ranges::sort(sorted);
  const auto above = std::ranges::upper_bound(sorted, at);
  const auto right = std::clamp<std::ptrdiff_t>(above - sorted.begin(), 1,
                                                static_cast<std::ptrdiff_t>(sorted.size()) - 1);
  return sorted[static_cast<std::size_t>(right)] - sorted[static_cast<std::size_t>(right) - 1];
}

/// Whether what lies above half the height is in many pieces: pictures of one focus that somebody
/// shuffled. One object has one piece, two depths have two, and noise on a broad hill a few beside
/// many pictures.
bool is_in_pieces(const FocusCurve& curve) {
  if (curve.empty()) return false;
  constexpr int kFewestPieces = 4;
  const double half = curve.floor() + curve.height() / 2;
  int above = 0, pieces = 0;
  bool was_above = false;
  for (const Evaluation& e : curve.evaluations()) {
    const bool is_above = e.score > half;
    above += is_above;
    pieces += is_above && !was_above;
    was_above = is_above;
  }
  return pieces >= kFewestPieces && 2 * pieces > above;
}

/// More than half of them.
bool most(std::size_t count, std::size_t all) { return 2 * count > all; }

template <class Condition>
std::size_t count_of(const std::vector<MethodTally>& methods, const Condition& condition) {
  return static_cast<std::size_t>(std::ranges::count_if(methods, condition));
}

/// Why the methods have no focus in common, if so. Sets consensus and tolerance where most have one.
std::optional<NoConsensus> agree(MetricComparison& comparison, const WindowStack& stack) {
  auto& methods = comparison.methods;
  const auto stands_out = [](const MethodTally& m) { return m.answer.stands_out; };
  const auto at_end = [](const MethodTally& m) {
    return m.answer.stands_out && m.answer.is_at_end;
  };
  const auto in_pieces = [](const MethodTally& m) { return is_in_pieces(m.answer.curve); };
  const std::size_t found = count_of(methods, stands_out);
  if (!most(found, methods.size())) return NoConsensus::no_peak;
  if (most(count_of(methods, in_pieces), methods.size())) return NoConsensus::out_of_order;
  if (most(count_of(methods, at_end), found)) return NoConsensus::at_end;
  const double consensus =
      median(values_of(methods, [](const auto& m) { return m.answer.peak.position; }));
  comparison.consensus = consensus;
  constexpr double kPartOfWidth = 0.1;
  const std::vector<double> widths = widths_of(methods);
  comparison.tolerance = std::max(spacing_at(stack.positions(), consensus),
                                  widths.empty() ? 0 : kPartOfWidth * median(widths));
  for (MethodTally& method : methods) {
    method.off = method.answer.peak.position - consensus;
    method.agrees = method.answer.stands_out && std::abs(method.off) <= comparison.tolerance;
  }
  const std::size_t agreed = count_of(methods, [](const MethodTally& m) { return m.agrees; });
  if (!most(agreed, methods.size())) return NoConsensus::disagreement;
  return std::nullopt;
}

/// How a method fares under noise of one strength.
struct Trial {
  int lost = 0;
  double squares = 0;  ///< Of its distances from the consensus.
};

/// `alive`: which methods are asked; those that lose the focus are not any more.
std::vector<Trial> try_noise(const std::vector<FocusMethod>& methods, const WindowStack& stack,
                             double added, std::vector<bool>& alive,
                             const MetricComparison& comparison) {
  std::vector<Trial> trials(methods.size());
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const WindowStack noisy = stack.with_noise(added, static_cast<std::uint64_t>(seed));
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (!alive[i]) continue;
      const Peak peak = methods[i].find(noisy, std::hypot(added, comparison.noise)).peak;
      const double off = std::abs(peak.position - *comparison.consensus);
      trials[i].squares += off * off;
      if (!(off <= comparison.tolerance) && ++trials[i].lost > kMostLost) alive[i] = false;
    }
  }
  return trials;
}

void add_noise(const std::vector<FocusMethod>& methods, const WindowStack& stack,
               MetricComparison& comparison, const Told& told) {
  std::vector<bool> alive;
  for (const MethodTally& method : comparison.methods) alive.push_back(method.agrees);
  std::size_t done = 0;
  for (const double multiple : kMultiples) {
    told(++done, std::size(kMultiples));
    const auto trials = try_noise(methods, stack, multiple * comparison.noise, alive, comparison);
    for (std::size_t i = 0; i < methods.size(); ++i) {
      if (!alive[i]) continue;
      MethodTally& method = comparison.methods[i];
      method.stands = multiple;
      method.stands_all = done == std::size(kMultiples);
      method.scatter = std::sqrt(trials[i].squares / kSeeds);
    }
    if (std::ranges::find(alive, true) == alive.end()) return;
  }
}

/// Most noise first, then fewest local maxima, then least scatter under that noise.
bool is_better(const MethodTally& a, const MethodTally& b) {
  if (a.stands != b.stands) return a.stands > b.stands;
  if (a.answer.maxima != b.answer.maxima) return a.answer.maxima < b.answer.maxima;
  return a.scatter < b.scatter;
}

Advantage advantage_of(const MethodTally& best, const MethodTally& next) {
  if (best.stands != next.stands) return Advantage::most_noise;
  if (best.answer.maxima != next.answer.maxima) return Advantage::fewest_maxima;
  return Advantage::least_scatter;
}

void recommend(MetricComparison& comparison) {
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < comparison.methods.size(); ++i) {
    if (comparison.methods[i].agrees) candidates.push_back(i);
  }
  std::ranges::stable_sort(candidates, [&](std::size_t a, std::size_t b) {
    return is_better(comparison.methods[a], comparison.methods[b]);
  });
  comparison.recommended = candidates.front();
  if (candidates.size() < 2) return;
  comparison.advantage =
      advantage_of(comparison.methods[candidates[0]], comparison.methods[candidates[1]]);
}

}  // namespace

MetricComparison compare_metrics(const std::vector<FocusMethod>& methods, const WindowStack& stack,
                                 double noise, const Told& told) {
  if (stack.size() < kFewestPictures) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a focus curve takes pictures at {} lens positions or more, and {}",
                            kFewestPictures,
                            stack.size() == 1 ? std::string("there is one")
                                              : fmt::format("there are {}", stack.size())));
  }
  MetricComparison comparison;
  comparison.noise = noise;
  for (const FocusMethod& method : methods)
    comparison.methods.push_back({.name = method.name, .answer = method.find(stack, noise)});
  constexpr double kHighHill = 0.5;
  const auto has_second = [](const MethodTally& m) { return m.answer.second_hill >= kHighHill; };
  comparison.has_second_hill =
      most(count_of(comparison.methods, has_second), comparison.methods.size());
  comparison.doubt = agree(comparison, stack);
  if (comparison.doubt) return comparison;
  add_noise(methods, stack, comparison, told);
  recommend(comparison);
  return comparison;
}

}  // namespace fathom
