// SPDX-License-Identifier: Apache-2.0
// How evaluations and foci look on the screen.
#pragma once

#include <string>

#include "focus/focus.hpp"
#include "session/rig.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {

/// {"loop":..,"position":..,"score":..} (sweeps, which have no loop, leave it out).
void print_evaluation(const Evaluation& evaluation, bool with_loop);

/// Follows one search: a progress line, and a JSON line an evaluation where asked for.
class SearchView {
 public:
  /// label: what is being searched, e.g. "1400 mm"; may be empty.
  SearchView(std::string label, std::string unit, bool json_lines)
      : label_(std::move(label)), unit_(std::move(unit)), json_lines_(json_lines) {}

  void show(const Evaluation& evaluation);

 private:
  Progress progress_;
  std::string label_;
  std::string unit_;
  bool json_lines_;
  Evaluation best_;
};

/// "focused at 740.3 +- 0.2 steps, confidence 0.97: score ..., 18 evaluations; why".
std::string describe(const Focus& focus, const std::string& unit);

/// Where the peaks of all lobes are.
std::vector<double> positions_of(std::span<const Peak> lobes);

/// Adds result, position, nearest (the position that the lens can take), sigma, score, confidence,
/// shape, r_squared, lobes (the positions of all peaks) and evaluations.
JsonLine& add_focus(JsonLine& line, const Focus& focus, const LensInfo& lens);

/// "time: 61.2 s moving, 4.0 s settling, 0.9 s exposing, 61 us computing".
std::string describe(const TimeSpent& spent);

}  // namespace fathom::cli
