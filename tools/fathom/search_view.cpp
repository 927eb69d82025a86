// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/search_view.hpp"

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
  return fmt::format("{}{} {:g} {}: score {:.6g}, {} evaluations; {}", to_string(focus.result()),
                     focus.result() == FocusResult::no_focus ? ", though best at" : " at",
                     focus.position, unit, focus.score, focus.evaluations.size(),
                     focus.verdict.reason);
}

}  // namespace fathom::cli
