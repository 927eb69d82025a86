// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/metric_comparison_view.hpp"

#include <fmt/format.h>

#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/palette.hpp"
#include "tools/fathom/plot.hpp"

namespace fathom::cli {
namespace {

std::string stands_text(const MethodTally& method) {
  return fmt::format("{}{:g} x", method.stands_all ? ">= " : "", method.stands);
}

std::string why_not(NoConsensus doubt) {
  switch (doubt) {
    case NoConsensus::no_peak:
      return "most curves are flat, or no more than noise: there is no focus to find, or the "
             "window "
             "has nothing to focus on";
    case NoConsensus::at_end:
      return "the curves rise to an end of the pictures: the focus lies beyond, so take more there";
    case NoConsensus::disagreement:
      return "their peaks lie in different places: two depths may be in the window, so try a "
             "smaller "
             "--window";
    case NoConsensus::out_of_order:
      return "the curves go up and down from picture to picture: are they in the order in which "
             "the "
             "lens moved? A manifest.csv says where each was taken";
  }
  return {};
}

std::string why(const MetricComparison& comparison, const std::string& unit) {
  const MethodTally& best = comparison.methods[*comparison.recommended];
  const std::string tolerance = fmt::format("within {:.3g} {}", comparison.tolerance, unit);
  if (best.stands == 0)
    return "lies " + tolerance + " of the consensus, and none stands more noise";
  const std::string stays =
      fmt::format("stays {} of the consensus with {}{:g} times the pictures' noise added",
                  tolerance, best.stands_all ? "at least " : "", best.stands);
  switch (comparison.advantage) {
    case Advantage::only_one:
      return comparison.methods.size() == 1 ? stays : stays + ", and no other agrees with it";
    case Advantage::most_noise:
      return stays + ", more than any other";
    case Advantage::fewest_maxima:
      return stays + ", and of those that do it has the fewest local maxima";
    case Advantage::least_scatter:
      return stays + fmt::format(", and of those that do its answers scatter least, by {:.2g}",
                                 best.scatter);
  }
  return stays;
}

const char* to_text(NoConsensus doubt) {
  switch (doubt) {
    case NoConsensus::no_peak:
      return "no_peak";
    case NoConsensus::at_end:
      return "at_end";
    case NoConsensus::disagreement:
      return "disagreement";
    case NoConsensus::out_of_order:
      return "out_of_order";
  }
  return "";
}

const char* to_text(Advantage advantage) {
  switch (advantage) {
    case Advantage::only_one:
      return "only_one";
    case Advantage::most_noise:
      return "most_noise";
    case Advantage::fewest_maxima:
      return "fewest_maxima";
    case Advantage::least_scatter:
      return "least_scatter";
  }
  return "";
}

std::string_view truth(bool value) { return value ? "true" : "false"; }

void print_json(const MethodTally& method, bool has_consensus) {
  const StackAnswer& answer = method.answer;
  const double range[] = {answer.low, answer.high};
  JsonLine line;
  line.add("metric", method.name)
      .add_json("stands_out", truth(answer.stands_out))
      .add_json("at_end", truth(answer.is_at_end))
      .add("peak", answer.peak.position)
      .add("sigma", answer.peak.sigma)
      .add("width", 2 * answer.peak.half_width)
      .add("range", std::span(range))
      .add("contrast", answer.contrast)
      .add("maxima", answer.maxima);
  has_consensus ? line.add("off", method.off) : line.add_null("off");
  line.add_json("agrees", truth(method.agrees))
      .add("stands_noise", method.stands)
      .add_json("stands_all", truth(method.stands_all))
      .add("scatter", method.scatter);
  print_line(line.text());
}

/// From 0 far from focus to 1 at the highest; the place alone of a method without a curve.
Curve drawn(const MethodTally& method, const char* colour) {
  Curve curve{CurveStyle::line, method.name, {}, colour};
  if (method.agrees) curve.title += ", stands " + stands_text(method);
  const FocusCurve& scores = method.answer.curve;
  if (scores.empty() && method.answer.stands_out) {
    const double at = method.answer.peak.position;
    curve.points = {{at, 0}, {at, 1}};
  }
  const double height = scores.empty() ? 0 : scores.height();
  for (const Evaluation& e : scores.evaluations()) {
    curve.points.push_back({e.position, height > 0 ? (e.score - scores.floor()) / height : 0});
  }
  return curve;
}

}  // namespace

void print_table(const MetricComparison& comparison, const std::string& unit) {
  constexpr const char* kRow = "{:<34} {:>9} {:>8} {:>8} {:>15} {:>9} {:>7} {:>8}";
  print_line(fmt::format(kRow, fmt::format("metric ({})", unit), "peak", "off", "width", "range",
                         "contrast", "maxima", "stands"));
  for (const MethodTally& method : comparison.methods) {
    const StackAnswer& answer = method.answer;
    const bool has_focus = answer.stands_out && !answer.is_at_end,
               has_curve = !answer.curve.empty();
    print_line(fmt::format(
        kRow, method.name,
        has_focus           ? fmt::format("{:.5g}", answer.peak.position)
        : answer.stands_out ? "at end"
                            : "none",
        has_focus && comparison.consensus ? fmt::format("{:+.2g}", method.off) : "-",
        has_focus && has_curve ? fmt::format("{:.3g}", 2 * answer.peak.half_width) : "-",
        has_focus ? fmt::format("{:.4g} .. {:.4g}", answer.low, answer.high) : "-",
        has_curve ? fmt::format("{:.3g}", answer.contrast) : "-", answer.maxima,
        method.agrees ? stands_text(method) : "-"));
  }
  print_line(
      "\npeak: of a fit. off: from the consensus. width: at half the height. range: the hill that "
      "the "
      "peak is on.\ncontrast: the highest score over that far from focus. maxima: hills that are "
      "more "
      "than noise.\nstands: noise that may be added, in multiples of the pictures' own, before the "
      "peak leaves the consensus.");
}

void print_result(const MetricComparison& comparison, const std::string& unit) {
  if (comparison.has_second_hill && comparison.doubt != NoConsensus::out_of_order)
    note("most curves have a second hill half as high or more: two depths may be in the window");
  if (comparison.consensus) {
    print_line(fmt::format("consensus: {:.5g} {}, the median of the peaks; tolerance {:.3g}",
                           *comparison.consensus, unit, comparison.tolerance));
  }
  if (comparison.doubt) {
    print_line("recommended: none, because " + why_not(*comparison.doubt));
    return;
  }
  print_line(fmt::format("recommended: {}, because it {}",
                         comparison.methods[*comparison.recommended].name, why(comparison, unit)));
}

void print_json(const MetricComparison& comparison, const std::string& unit) {
  for (const MethodTally& method : comparison.methods)
    print_json(method, comparison.consensus.has_value());
  JsonLine line;
  comparison.consensus ? line.add("consensus", *comparison.consensus) : line.add_null("consensus");
  line.add("tolerance", comparison.tolerance).add("unit", unit).add("noise", comparison.noise);
  if (comparison.doubt) {
    line.add_null("recommended").add("why", to_text(*comparison.doubt));
  } else {
    line.add("recommended", comparison.methods[*comparison.recommended].name)
        .add("why", to_text(comparison.advantage));
  }
  print_line(line.text());
}

void draw(const std::string& path, const MetricComparison& comparison, const std::string& name,
          const LensInfo& lens) {
  std::vector<Curve> curves;
  for (const MethodTally& method : comparison.methods) {
    constexpr std::size_t kRound = std::size(palette::kTurns);
    const std::size_t turn = curves.size();
    curves.push_back(drawn(method, palette::kTurns[turn % kRound]));
    if (turn >= kRound) curves.back().style = CurveStyle::samples;  // apart from the first round
  }
  if (comparison.consensus) {
    curves.push_back({CurveStyle::dashed,
                      fmt::format("consensus: {:.5g}", *comparison.consensus),
                      {{*comparison.consensus, 0}, {*comparison.consensus, 1}}});
  }
  write_curves(path, curves,
               {.title = "Metrics on " + name,
                .x = position_label(lens),
                .y = "score, from far from focus to the highest",
                .key = "below height 1.5",
                .height_px = 640});
}

}  // namespace fathom::cli
