// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/search_view.hpp"

#include "engine/printable.hpp"
#include "session/focus_json.hpp"
#include "words/verdict_words.hpp"

namespace fathom::cli {

std::string evaluation_json(const Evaluation& evaluation, bool with_loop, const std::string& file) {
  JsonLine line;
  if (with_loop) line.add("loop", evaluation.loop);
  line.add("position", evaluation.position).add("score", evaluation.score);
  if (!file.empty()) line.add("file", file);
  return line.text();
}

namespace {

/// What --json tells of a picture on the way, beside its place.
JsonLine& add_way(JsonLine& line, const OnTheWay& way) {
  return line.add("sigma", way.sigma).add("smear", way.smear);
}

std::string search_json(int loop, const Measurement& measurement) {
  if (!measurement.on_the_way)
    return evaluation_json({loop, measurement.position, measurement.score}, true);
  JsonLine line;
  line.add("loop", loop).add("position", measurement.position).add("score", measurement.score);
  return add_way(line, *measurement.on_the_way).text();
}

}  // namespace

void SearchView::began(const Run&, std::size_t) {
  loop_ = 0;
  best_ = {};
}

void SearchView::evaluated(const Measurement& measurement) {
  const Evaluation evaluation{++loop_, measurement.position, measurement.score};
  if (json_lines_) print_line_on_the_way(search_json(evaluation.loop, measurement));
  if (best_.loop == 0 || evaluation.score > best_.score) best_ = evaluation;
  progress_.show([&] {
    return fmt::format("{}{}loop {:>3}  position {:g} {}  score {:.4g}  best at {:g}", label_,
                       label_.empty() ? "" : "  ", evaluation.loop, evaluation.position, unit_,
                       evaluation.score, best_.position);
  });
}

void SearchView::found(const Focus&) { progress_.clear(); }

void SearchView::warned(const Warning&) { progress_.clear(); }

namespace {

std::string sweep_json(const Measurement& measurement, const LensInfo& lens) {
  if (!measurement.on_the_way) {
    return evaluation_json({0, measurement.position, measurement.score}, false,
                           nearest_name(lens, measurement.position));
  }
  JsonLine line;
  line.add("position", measurement.position).add("score", measurement.score);
  return add_way(line, *measurement.on_the_way).text();
}

}  // namespace

void SweepView::began(const Run&, std::size_t positions) { positions_ = positions; }

void SweepView::evaluated(const Measurement& measurement) {
  if (json_lines_) print_line_on_the_way(sweep_json(measurement, lens_));
  ++done_;
  if (positions_ == 0) {
    progress_.show([&] {
      return fmt::format("{}  position {:.6g} {}  score {:.4g}", label_, measurement.position,
                         lens_.unit, measurement.score);
    });
    return;
  }
  progress_.bar(label_, done_, positions_);
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

void print_picture(const LensInfo& lens, double position) {
  const std::string name = nearest_name(lens, position);
  if (!name.empty()) print_line("nearest picture: " + printable(name));
}

std::vector<double> positions_of(std::span<const Peak> lobes) {
  std::vector<double> positions;
  for (const Peak& lobe : lobes) positions.push_back(lobe.position);
  return positions;
}

JsonLine& add_focus(JsonLine& line, const Focus& focus, const LensInfo& lens) {
  return line.add_members(focus_members(focus, lens));
}

JsonLine& add_journey(JsonLine& line, const Journey& journey) {
  return line.add_json("moving", journey.on_the_way > 0 ? "true" : "false")
      .add("travel", journey.travel)
      .add("rig_seconds", journey.rig_seconds)
      .add("frames", journey.frames);
}

std::string describe(const Journey& journey, const TimeSpent& spent, const std::string& unit) {
  const std::string on_the_way =
      journey.on_the_way > 0 ? fmt::format(", {} of them on the way", journey.on_the_way) : "";
  return fmt::format(
      "time: {:.3g} s moving, {:.3g} s settling, {:.3g} s exposing, {:.3g} ms computing; travel "
      "{:g} {}, {} frames{}",
      spent.moving, spent.settling, spent.exposing, 1e3 * spent.computing, journey.travel, unit,
      journey.frames, on_the_way);
}

}  // namespace fathom::cli
