// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/search_view.hpp"

#include "tools/fathom/verdict_words.hpp"

namespace fathom::cli {

void print_evaluation(const Evaluation& evaluation, bool with_loop) {
  JsonLine line;
  if (with_loop) line.add("loop", evaluation.loop);
  print_line(line.add("position", evaluation.position).add("score", evaluation.score).text());
}

void SearchView::show(const Evaluation& evaluation) {
  if (json_lines_) print_evaluation(evaluation, true);
  if (best_.loop == 0 || evaluation.score > best_.score) best_ = evaluation;
  progress_.show([&] {
    return fmt::format("{}{}loop {:>3}  position {:g} {}  score {:.4g}  best at {:g}", label_,
                       label_.empty() ? "" : "  ", evaluation.loop, evaluation.position, unit_,
                       evaluation.score, best_.position);
  });
}

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
  return line.add("result", to_string(focus.result()))
      .add("position", focus.peak.position)
      .add("nearest", nearest_position(lens, focus.peak.position))
      .add("sigma", focus.peak.sigma)
      .add("score", focus.peak.score)
      .add("confidence", focus.verdict.confidence)
      .add("shape", to_string(focus.peak.shape))
      .add("r_squared", focus.peak.r_squared)
      .add("lobes", positions_of(focus.lobes))
      .add("evaluations", focus.evaluations.size());
}

std::string describe(const TimeSpent& spent) {
  return fmt::format(
      "time: {:.3g} s moving, {:.3g} s settling, {:.3g} s exposing, {:.3g} ms computing",
      spent.moving, spent.settling, spent.exposing, 1e3 * spent.computing);
}

}  // namespace fathom::cli
