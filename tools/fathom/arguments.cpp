// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/arguments.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"
#include "focus/searches.hpp"
#include "mapping/window_choice.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/named_options.hpp"
#include "tools/fathom/patience.hpp"

namespace fathom::cli {

void MetricArguments::add_to(Verb& verb, bool with_rings, const std::string& window_more) {
  device.on_work = patient_words();
  verb.add_option("--window", window,
                  "X,Y,N: left column, top row and side of the window in pixels "
                  "(default: 64 x 64 at the centre)" +
                      window_more);
  verb.add_option("--metric", metric,
                  fmt::format("What is computed of a window, such as fft:64:hann{} "
                              "(fathom help metrics)",
                              with_rings ? ", or K numbers with :rings=K" : ""))
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
  if (mapping::window_wish(window)) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("--window {} is of focus, range and sweep, which look round for it; "
                            "name one here: X,Y,N",
                            window));
  }
  return parse_window(window);
}

void add_rig_option(Verb& verb, std::string& rig, bool required) {
  Option option = verb.add_option(
      "--rig", rig,
      "sim[:key=value,...], replay:PATH (a folder or a multi-page TIFF), v4l2:/dev/video0, "
      "FILE.toml and others (fathom help rigs)");
  if (required) option.required();
}

Option RigArguments::add_to(Verb& verb, const std::string& output_help, bool rig_required,
                            const std::string& window_more) {
  add_rig_option(verb, rig, rig_required);
  metric.add_to(verb, false, window_more);
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

std::vector<NamedOption> search_names() {
  std::vector<NamedOption> names;
  for (const Search& search : searches()) names.push_back({search.name, ""});
  return names;
}

}  // namespace

void SearchArguments::add_to(Verb& verb, bool with_range) {
  verb.add_option("--search", search,
                  "How to search: " + listed(search_names(), " or ") + " (fathom help searches)")
      .shows_default();
  verb.add_option("--peak", peak,
                  "The answer: fit (may lie between steps) or evaluated (the best position that "
                  "was looked at, as in the thesis)")
      .shows_default();
  verb.add_option(
      "--bracket", bracket,
      "A,X,B: lens positions with the peak between A and B, as golden, fibonacci and brent need "
      "them; without it a coarse pass over the travel finds them");
  verb.add_option(
      "--tolerance", tolerance,
      "Longest interval that golden, fibonacci and brent end with; hill's last step; coarse ends "
      "when the peak is known to an eighth of it, spectral to three quarters (default: 2 steps)");
  verb.add_option(
      "--frames", frames,
      "No more frames than this, 3 or more: the focus from their spectra, with the sigma "
      "that they leave (needs a lens whose blur is known)");
  verb.add_flag(
      "--moving", is_moving,
      "Take pictures while the lens travels, and say why where it must halt for them "
      "(default: where the lens can be watched, its blur is known and the camera streams)");
  verb.add_flag("--halting", is_halting, "Halt the lens for every picture");
  verb.add_option("--blur", blur_px,
                  "Blur that each unit of travel away from focus adds, px of diameter (default: "
                  "what the lens says)");
  verb.add_option("--na", aperture,
                  "Of a microscope that moves in um, in place of --blur: its numerical aperture, "
                  "with --pixel");
  verb.add_option("--pixel", pixel_um, "Side of a pixel on the object, um");
  verb.add_option("--wavelength", wavelength_nm, "Of the light, nm (default: 550)");
  if (!with_range) return;
  verb.add_option("--from", from, "First lens position to search (default: the lens's lowest)");
  verb.add_option("--to", to, "Last lens position to search (default: the lens's highest)");
}

namespace {

std::optional<BlurModel> blur_of(const SearchArguments& arguments) {
  const bool has_microscope = arguments.aperture || arguments.pixel_um || arguments.wavelength_nm;
  if (arguments.blur_px && has_microscope) {
    throw Error(ErrorCode::bad_argument,
                "--blur and --na say the same in two ways; leave one of them out");
  }
  if (arguments.blur_px) {
    const BlurModel model{.px_per_unit = *arguments.blur_px};
    require_valid(model);
    return model;
  }
  if (!has_microscope) return std::nullopt;
  if (!arguments.aperture || !arguments.pixel_um) {
    throw Error(ErrorCode::bad_argument,
                "the blur of a microscope follows from --na and --pixel together");
  }
  constexpr double kGreen_nm = 550;
  return blur_of_microscope(*arguments.aperture, arguments.wavelength_nm.value_or(kGreen_nm),
                            *arguments.pixel_um);
}

}  // namespace

namespace {

std::optional<bool> moving_of(const SearchArguments& arguments) {
  if (arguments.is_moving && arguments.is_halting) {
    throw Error(ErrorCode::bad_argument,
                "--moving and --halting contradict each other; leave one of them out");
  }
  if (!arguments.is_moving && !arguments.is_halting) return std::nullopt;
  return arguments.is_moving;
}

}  // namespace

FocusRequest SearchArguments::request() const {
  FocusRequest request;
  request.from = from;
  request.to = to;
  request.tolerance = tolerance;
  request.frames = frames;
  request.moving = moving_of(*this);
  request.blur = blur_of(*this);
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
