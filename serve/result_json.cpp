// SPDX-License-Identifier: Apache-2.0
#include "serve/result_json.hpp"

#include <fmt/format.h>

#include <vector>

#include "serve/publisher.hpp"
#include "session/json_line.hpp"
#include "words/calibration_words.hpp"
#include "words/verdict_words.hpp"

namespace fathom::serve {
namespace {

std::string pair_of(double a, double b) { return fmt::format("[{:.9g},{:.9g}]", a, b); }

/// The fitted shape as a line; empty where nothing was fitted.
std::string shape_of(const Peak& peak, double floor) {
  constexpr int kHalf = 32;
  std::string text = "[";
  // A parabola says nothing of what lies beyond its points.
  const double reach = peak.shape == PeakShape::parabola ? 1 : 3;
  const bool is_drawn = peak.shape != PeakShape::none && peak.half_width > 0;
  for (int i = -kHalf; is_drawn && i <= kHalf; ++i) {
    const double far = reach * i / kHalf;
    const double score = floor + (peak.score - floor) * height_at(peak.shape, far);
    text += (text.size() > 1 ? "," : "") + pair_of(peak.position + far * peak.half_width, score);
  }
  return text + "]";
}

std::string lobes_of(const std::vector<Peak>& lobes) {
  std::string text = "[";
  for (const Peak& lobe : lobes) {
    text += text.size() > 1 ? "," : "";
    text += JsonLine().add("position", lobe.position).add("score", lobe.score).text();
  }
  return text + "]";
}

/// A verdict's words say first why, and then what may help.
void add_words(JsonLine& line, const std::string& words) {
  const std::size_t end = words.find("; ");
  line.add("words", words.substr(0, end));
  const std::string advice = end == std::string::npos ? "" : words.substr(end + 2);
  line.add_json("advice",
                advice.empty() ? "[]" : "[" + JsonLine().add("", advice).body().substr(3) + "]");
}

void add_focus(JsonLine& line, const Focus& focus) {
  line.add("position", focus.position()).add("sigma", focus.peak.sigma);
  line.add("confidence", focus.verdict.confidence);
  line.add("verdict", to_string(focus.result()));
  line.add("reason", to_string(focus.verdict.reason.why));
  add_words(line, words_for(focus.verdict, page_terms()));
  line.add("score", focus.peak.score).add("floor", focus.floor);
  line.add_json("lobes", lobes_of(focus.lobes)).add_json("fit", shape_of(focus.peak, focus.floor));
}

void add_no_focus(JsonLine& line, const Outcome& outcome) {
  outcome.best ? line.add("position", outcome.best->position) : line.add_null("position");
  line.add_null("sigma").add_null("confidence").add_null("verdict").add_null("reason");
  line.add("words", outcome.words).add_json("advice", "[]");
  outcome.best ? line.add("score", outcome.best->score) : line.add_null("score");
  line.add_null("floor").add_json("lobes", "[]").add_json("fit", "[]");
}

void add_or_null(JsonLine& line, const char* key, const std::string& text) {
  text.empty() ? line.add_null(key) : line.add(key, text);
}

}  // namespace

std::string result_json(const Outcome& outcome, const LensInfo& lens) {
  JsonLine line;
  outcome.focus ? add_focus(line, *outcome.focus) : add_no_focus(line, outcome);
  const std::string picture =
      outcome.focus ? nearest_name(lens, outcome.focus->position()) : std::string();
  add_or_null(line, "picture", picture);
  if (outcome.distance) {
    line.add_json("distance", JsonLine()
                                  .add("value", outcome.distance->mm)
                                  .add("sigma", outcome.distance->sigma_mm)
                                  .add("unit", "mm")
                                  .text());
  } else {
    line.add_null("distance");
  }
  line.add_json("window", outcome.window ? JsonLine()
                                               .add("x", outcome.window->x)
                                               .add("y", outcome.window->y)
                                               .add("n", outcome.window->n)
                                               .text()
                                         : "null");
  add_or_null(line, "error", outcome.error);
  add_or_null(line, "run", outcome.run);
  add_or_null(line, "folder", outcome.folder);
  return line.text();
}

namespace {

std::string parameters_of(const Calibration& calibration) {
  std::string text = "[";
  for (const CalibrationParameter& one : calibration.parameters()) {
    text += text.size() > 1 ? "," : "";
    text += JsonLine().add("name", one.name).add("value", one.value).add("sigma", one.sigma).text();
  }
  return text + "]";
}

std::string curve_of(const Calibration& calibration) {
  constexpr int kPoints = 64;
  const double low = calibration.lowest_position(), high = calibration.highest_position();
  std::string text = "[";
  for (int i = 0; i <= kPoints; ++i) {
    const double position = low + (high - low) * i / kPoints;
    const double distance = calibration.distance_mm(position);
    if (std::isfinite(distance)) text += (text.size() > 1 ? "," : "") + pair_of(position, distance);
  }
  return text + "]";
}

std::string outliers_of(const Calibration& calibration) {
  std::string text = "[";
  for (std::size_t i = 0; i < calibration.points().size(); ++i) {
    text += i > 0 ? "," : "";
    text += calibration.left_out(i) ? "true" : "false";
  }
  return text + "]";
}

}  // namespace

std::string fit_json(const Calibration& calibration, const std::string& name) {
  JsonLine line;
  line.add("model", calibration.model().formula().name).add("equation", calibration.equation());
  line.add_json("parameters", parameters_of(calibration));
  line.add("r_squared", calibration.r_squared());
  line.add("position_scatter", calibration.position_scatter());
  line.add("residuals_mm", calibration.residuals_mm());
  line.add_json("left_out", outliers_of(calibration)).add_json("curve", curve_of(calibration));
  add_or_null(line, "name", name);
  return line.text();
}

}  // namespace fathom::serve
