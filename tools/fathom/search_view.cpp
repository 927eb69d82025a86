// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/search_view.hpp"

#include "session/focus_json.hpp"
#include "tools/fathom/verdict_words.hpp"

namespace fathom::cli {

void print_evaluation(const Evaluation& evaluation, bool with_loop) {
  JsonLine line;
  if (with_loop) line.add("loop", evaluation.loop);
  print_line(line.add("position", evaluation.position).add("score", evaluation.score).text());
}

void SearchView::began(const Run&, std::size_t) {
  loop_ = 0;
  best_ = {};
}

void SearchView::evaluated(const Measurement& measurement) {
  const Evaluation evaluation{++loop_, measurement.position, measurement.score};
  if (json_lines_) print_evaluation(evaluation, true);
  if (best_.loop == 0 || evaluation.score > best_.score) best_ = evaluation;
  progress_.show([&] {
    return fmt::format("{}{}loop {:>3}  position {:g} {}  score {:.4g}  best at {:g}", label_,
                       label_.empty() ? "" : "  ", evaluation.loop, evaluation.position, unit_,
                       evaluation.score, best_.position);
  });
}

void SearchView::found(const Focus&) { progress_.clear(); }

void SearchView::warned(const Warning&) { progress_.clear(); }

void SweepView::began(const Run&, std::size_t positions) { positions_ = positions; }

void SweepView::evaluated(const Measurement& measurement) {
  if (json_lines_) print_evaluation({0, measurement.position, measurement.score}, false);
  progress_.bar(label_, ++done_, positions_);
  if (done_ == positions_) progress_.clear();
}

void SweepView::warned(const Warning&) { progress_.clear(); }

std::string describe(const Focus& focus, const std::string& unit) {
  const Peak& peak = focus.peak;
  const bool is_answer = focus.result() == FocusResult::focused;
  const std::string place =
      is_answer ? fmt::format(" at {:.6g} +- {:.2g} {}, confidence {:.2f}", peak.position,
                              peak.sigma, unit, focus.verdict.confidence)
      : focus.result() == FocusResult::no_focus
          ? fmt::format(", though best at {:.6g} {}", peak.position, unit)
          : fmt::format(" at {:.6g} {}", peak.position, unit);
  return fmt::format("{}{}: score {:.6g}, {} evaluations; {}", to_string(focus.result()), place,
                     peak.score, focus.evaluations.size(), words_for(focus.verdict));
}

std::vector<double> positions_of(std::span<const Peak> lobes) {
  std::vector<double> positions;
  for (const Peak& lobe : lobes) positions.push_back(lobe.position);
  return positions;
}

JsonLine& add_focus(JsonLine& line, const Focus& focus, const LensInfo& lens) {
  return line.add_members(focus_members(focus, lens));
}

std::string describe(const TimeSpent& spent) {
  return fmt::format(
      "time: {:.3g} s moving, {:.3g} s settling, {:.3g} s exposing, {:.3g} ms computing",
      spent.moving, spent.settling, spent.exposing, 1e3 * spent.computing);
}

}  // namespace fathom::cli
