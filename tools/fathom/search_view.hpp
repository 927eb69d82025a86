// SPDX-License-Identifier: Apache-2.0
// How evaluations and foci look on the screen.
#pragma once

#include <string>

#include "focus/focus.hpp"
#include "session/observer.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {

/// {"loop":..,"position":..,"score":..} (sweeps, which have no loop, leave it out).
/// file: the picture of a recording, or empty.
std::string evaluation_json(const Evaluation& evaluation, bool with_loop,
                            const std::string& file = "");

/// Follows one search after the other: a progress line, and a JSON line an evaluation where asked
/// for.
class SearchView final : public Observer {
 public:
  /// label: what is being searched, e.g. "1400 mm"; may be empty.
  SearchView(std::string label, std::string unit, bool json_lines)
      : label_(std::move(label)), unit_(std::move(unit)), json_lines_(json_lines) {}

  void began(const Run& run, std::size_t positions) override;
  void evaluated(const Measurement& measurement) override;
  void found(const Focus& focus) override;
  void warned(const Warning& warning) override;

 private:
  Progress progress_;
  std::string label_;
  std::string unit_;
  bool json_lines_;
  int loop_ = 0;
  Evaluation best_;
};

/// Follows one sweep: a progress bar, and a JSON line an evaluation where asked for.
class SweepView final : public Observer {
 public:
  /// lens: what JSON lines name the pictures of a recording by.
  SweepView(std::string label, LensInfo lens, bool json_lines)
      : label_(std::move(label)), lens_(std::move(lens)), json_lines_(json_lines) {}

  void began(const Run& run, std::size_t positions) override;
  void evaluated(const Measurement& measurement) override;
  void warned(const Warning& warning) override;

 private:
  Progress progress_;
  std::string label_;
  LensInfo lens_;
  bool json_lines_;
  std::size_t done_ = 0, positions_ = 0;
};

/// Adds travel, rig_seconds and frames.
JsonLine& add_journey(JsonLine& line, const Journey& journey);

/// "focused at 740.3 +- 0.2 steps, confidence 0.97: score ..., 18 evaluations; why".
std::string describe(const Focus& focus, const std::string& unit);

/// Prints "nearest picture: pcb_012.png", for a recording; else nothing.
void print_picture(const LensInfo& lens, double position);

/// Where the peaks of all lobes are.
std::vector<double> positions_of(std::span<const Peak> lobes);

/// Adds the members of the JSON form of a focus (session/focus_json.hpp).
JsonLine& add_focus(JsonLine& line, const Focus& focus, const LensInfo& lens);

/// "time: 61.2 s moving, 4.0 s settling, 0.9 s exposing, 61 us computing".
std::string describe(const Journey& journey, const TimeSpent& spent, const std::string& unit);

}  // namespace fathom::cli
