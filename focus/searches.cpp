// SPDX-License-Identifier: Apache-2.0
#include "focus/searches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// A lens that says nothing of its depth of focus gets this many positions first, and halvings
/// until the peak shows, or the lens has no positions in between.
constexpr double kGuessedIntervals = 8;
constexpr int kGuessedHalvings = 5;

CoarsePass coarse_pass(const LensInfo& lens, const FocusLimits& limits) {
  CoarsePass pass;
  pass.is_guess = !(lens.coarse_spacing > 0);
  LensInfo spaced = lens;
  if (pass.is_guess) {
    spaced.coarse_spacing =
        std::max((limits.to - limits.from) / kGuessedIntervals, lens.resolution);
  }
  pass.halvings = pass.is_guess ? kGuessedHalvings : 1;
  pass.positions = coarse_positions(spaced, limits.from, limits.to);
  return pass;
}

/// Of a climb. Half of the widest spacing that hides no peak, but one that the lens can make: a
/// step that it rounds to nothing looks like a top.
double first_step(const LensInfo& lens, double travel) {
  if (!(lens.coarse_spacing > 0)) return std::max(travel / kGuessedIntervals, lens.resolution);
  if (!lens.stops.empty()) return lens.coarse_spacing;
  return std::max(lens.coarse_spacing / 2, lens.resolution);
}

double start_of(const FocusLimits& limits, const FocusRequest& request) {
  const double start = limits.bracket ? limits.bracket->inner : request.start.value_or(limits.from);
  return std::clamp(start, limits.from, limits.to);
}

void prepare_coarse(FocusLimits& limits, const FocusRequest&, const LensInfo& lens) {
  limits.coarse = coarse_pass(lens, limits);
}

/// With the coarse pass that follows where spectra do not tell.
void prepare_auto(FocusLimits& limits, const FocusRequest& request, const LensInfo& lens) {
  prepare_coarse(limits, request, lens);
  limits.blur = request.blur;
  if (limits.blur) limits.start = start_of(limits, request);
}

/// A bracket takes the place of the coarse pass.
void prepare_narrow(FocusLimits& limits, const FocusRequest&, const LensInfo& lens) {
  if (!limits.bracket) limits.coarse = coarse_pass(lens, limits);
}

void prepare_hill(FocusLimits& limits, const FocusRequest& request, const LensInfo& lens) {
  limits.start = start_of(limits, request);
  limits.first_step = std::max(first_step(lens, limits.to - limits.from), limits.tolerance);
}

void prepare_spectral(FocusLimits& limits, const FocusRequest& request, const LensInfo& lens) {
  // The pictures of a recording tell it together.
  if (lens.stops.empty() || request.frames) require_blur(request);
  prepare_auto(limits, request, lens);
}

/// Every position a tolerance apart, and every stop of a lens that has only certain ones.
void prepare_full(FocusLimits& limits, const FocusRequest&, const LensInfo& lens) {
  LensInfo spaced = lens;
  spaced.coarse_spacing = lens.stops.empty() ? limits.tolerance : 0;
  limits.coarse = {coarse_positions(spaced, limits.from, limits.to), 0, false};
}

void run_auto(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  auto_search(trace, limits.coarse, scatter, limits.tolerance);
}

/// What the searches that narrow an interval down begin with: the bracket, or the neighbours of the
/// best of a coarse pass.
Bracket bracket_of(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  if (limits.bracket) return *limits.bracket;
  run_coarse_pass(trace, limits.coarse, scatter);
  return bracket_around_best(trace.evaluations());
}

void run_golden(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  golden_section(trace, bracket_of(trace, limits, scatter), limits.tolerance);
}

void run_fibonacci(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  const Bracket bracket = bracket_of(trace, limits, scatter);
  fibonacci_section(trace, bracket.low, bracket.high, limits.tolerance);
}

void run_brent(SearchTrace& trace, const FocusLimits& limits, const Scatter& scatter) {
  const Bracket bracket = bracket_of(trace, limits, scatter);
  brent(trace, bracket.low, bracket.high, limits.tolerance);
}

void run_hill(SearchTrace& trace, const FocusLimits& limits, const Scatter&) {
  hill_climb(trace, limits.start, limits.first_step, limits.from, limits.to, limits.tolerance);
}

void run_full(SearchTrace& trace, const FocusLimits& limits, const Scatter&) {
  evaluate_all(trace, limits.coarse.positions);
}

constexpr std::array kSearches = {
    Search{.method = SearchMethod::automatic,
           .name = "auto",
           .help = "spectral where the blur is known, else coarse",
           .begins_at_start = false,
           .prepare = prepare_auto,
           .run = run_auto},
    Search{.method = SearchMethod::golden,
           .name = "golden",
           .help = "the thesis",
           .begins_at_start = false,
           .prepare = prepare_narrow,
           .run = run_golden},
    Search{.method = SearchMethod::fibonacci,
           .name = "fibonacci",
           .help = "",
           .begins_at_start = false,
           .prepare = prepare_narrow,
           .run = run_fibonacci},
    Search{.method = SearchMethod::brent,
           .name = "brent",
           .help = "",
           .begins_at_start = false,
           .prepare = prepare_narrow,
           .run = run_brent},
    Search{.method = SearchMethod::hill,
           .name = "hill",
           .help = "climbs from where the lens stands",
           .begins_at_start = true,
           .prepare = prepare_hill,
           .run = run_hill},
    Search{.method = SearchMethod::full,
           .name = "full",
           .help = "",
           .begins_at_start = false,
           .prepare = prepare_full,
           .run = run_full},
    Search{.method = SearchMethod::spectral,
           .name = "spectral",
           .help = "few pictures, by their spectra",
           .begins_at_start = true,
           .prepare = prepare_spectral,
           .run = run_auto},
    Search{.method = SearchMethod::coarse,
           .name = "coarse",
           .help = "a coarse pass, then where a fit asks",
           .begins_at_start = false,
           .prepare = prepare_coarse,
           .run = run_auto},
};

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kSearches.size(); ++i) {
    if (static_cast<std::size_t>(kSearches[i].method) != i) return false;
  }
  return true;
}
static_assert(is_in_order());

}  // namespace

std::span<const Search> searches() { return kSearches; }

const Search& search_of(SearchMethod method) {
  return kSearches.at(static_cast<std::size_t>(method));
}

const char* to_string(SearchMethod method) noexcept {
  const auto i = static_cast<std::size_t>(method);
  return i < kSearches.size() ? kSearches[i].name : "unknown";
}

SearchMethod parse_search_method(std::string_view name) {
  std::string names;
  for (const Search& search : kSearches) {
    if (name == search.name) return search.method;
    names += std::string(names.empty() ? "" : ", ") + search.name;
  }
  throw Error(ErrorCode::bad_argument, fmt::format("no search \"{}\"; there is {}", name, names));
}

}  // namespace fathom
