// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/arguments.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"
#include "focus/searches.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/named_options.hpp"
#include "tools/fathom/patience.hpp"

namespace fathom::cli {

void MetricArguments::add_to(Verb& verb, bool with_rings) {
  device.on_work = patient_words();
  verb.add_option("--window", window,
                  "X,Y,N: left column, top row and side of the window in pixels "
                  "(default: 64 x 64 at the centre)");
  verb.add_option("--metric", metric,
                  fmt::format("TRANSFORM[:N][:TAPER][:power][:band=LO-HI]{}; TRANSFORM is fft, "
                              "walsh-paley, walsh-sequency or walsh-hadamard",
                              with_rings ? "[:rings=K], K numbers a window" : ""))
      .shows_default();
  verb.add_option(
      "--backend", backend,
      "auto, NAME or NAME:DEVICE as fathom devices lists them (default: $FATHOM_BACKEND, "
      "else auto)");
  verb.add_option("--threads", device.threads,
                  "Processors that may compute, where the backend can use several (default: "
                  "$FATHOM_THREADS, else all)")
      .at_least_one();
}

std::optional<Window> MetricArguments::chosen_window() const {
  if (window.empty()) return std::nullopt;
  return parse_window(window);
}

void add_rig_option(Verb& verb, std::string& rig, bool required) {
  Option option = verb.add_option(
      "--rig", rig,
      "sim[:key=value,...], replay:PATH (a folder or a multi-page TIFF) or FILE.toml; see below");
  if (required) option.required();
  std::string text = "Rigs:\n";
  for (const RigDriver* driver : all_rig_drivers()) {
    text += fmt::format("  {:<8}{}\n", driver->name(), driver->summary());
  }
  verb.add_above_footer(text);
}

Option RigArguments::add_to(Verb& verb, const std::string& output_help, bool rig_required) {
  add_rig_option(verb, rig, rig_required);
  metric.add_to(verb);
  verb.add_option("--average", average, "Frames averaged for one score").shows_default();
  verb.add_flag("--json", json, "One JSON object a line on standard output");
  return verb.add_option("-o,--output", output, output_help);
}

std::optional<double> checked_step(std::optional<double> step) {
  if (!step || (*step > 0 && std::isfinite(*step))) return step;
  throw Error(ErrorCode::bad_argument,
              fmt::format("--step {} goes nowhere; it takes a number above 0", *step));
}

int checked_average(int average) {
  if (average >= 1) return average;
  throw Error(ErrorCode::bad_argument,
              fmt::format("cannot average {} frames; --average takes 1 or more", average));
}

RigOptions RigArguments::options() const {
  RigOptions options;
  options.rig = rig;
  options.metric = metric.metric;
  options.window = metric.chosen_window();
  options.backend = metric.backend;
  options.device = metric.device;
  options.shot.average = checked_average(average);
  options.shot.stop_requests = stop_requests;
  return options;
}

namespace {

std::vector<NamedOption> search_options() {
  std::vector<NamedOption> options;
  for (const Search& search : searches()) options.push_back({search.name, search.help});
  return options;
}

}  // namespace

void SearchArguments::add_to(Verb& verb, bool with_range) {
  verb.add_option("--search", search, "How to search: " + listed(search_options(), " or "))
      .shows_default();
  verb.add_option("--peak", peak,
                  "The answer: fit (may lie between steps) or evaluated (the best position that "
                  "was looked at, as in the thesis)")
      .shows_default();
  verb.add_option(
      "--bracket", bracket,
      "A,X,B: lens positions with the peak between A and B; without it a coarse pass over "
      "the travel finds them");
  verb.add_option(
      "--tolerance", tolerance,
      "Longest interval that golden, fibonacci and brent end with; hill's last step; auto ends "
      "when the peak is known to an eighth of it (default: 2 steps)");
  if (!with_range) return;
  verb.add_option("--from", from, "First lens position to search (default: the lens's lowest)");
  verb.add_option("--to", to, "Last lens position to search (default: the lens's highest)");
}

FocusRequest SearchArguments::request() const {
  FocusRequest request;
  request.from = from;
  request.to = to;
  request.tolerance = tolerance;
  request.search = parse_search_method(search);
  request.peak = parse_peak_method(peak);
  if (!bracket.empty()) request.bracket = parse_bracket(bracket);
  if (request.bracket && (from || to)) {
    throw Error(ErrorCode::bad_argument,
                "--bracket says where to search already; leave --from and --to out");
  }
  return request;
}

std::string position_label(const LensInfo& lens) {
  return fmt::format("lens position ({})", lens.unit);
}

std::string score_label(const MetricSpec& spec) { return "focus quality, " + spec.text(); }

}  // namespace fathom::cli
