// SPDX-License-Identifier: Apache-2.0
// fathom compare-metrics: which metric suits these pictures.
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/error.hpp"
#include "focus/blur.hpp"
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/metric_comparison_view.hpp"
#include "tools/fathom/patience.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/spectral_method.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_notes.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  std::string stack, rig;
  MetricArguments metric;  // but for the metric itself
  std::vector<std::string> metrics;
  std::optional<double> from, to, step;
  int average = 1;
  std::string plot;
  bool json = false;
};

std::string rig_of(const Arguments& arguments) {
  if (arguments.stack.empty() == arguments.rig.empty()) {
    throw Error(ErrorCode::bad_argument,
                "compare-metrics takes a stack of pictures or a --rig: name one of them");
  }
  return arguments.stack.empty() ? arguments.rig : "replay:" + arguments.stack;
}

void require_picture(const std::string& plot) {
  if (plot.empty() || is_picture(plot)) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("cannot plot to {}; name a file ending in .svg or .png", plot));
}

/// Keeps the window of every picture of a sweep, and the least noise that any of them shows: texture
/// as fine as pixels adds to it.
class StackKeeper final : public Observer {
 public:
  StackKeeper(const Window& window, Depth depth) : window_(window), stack(window.n, depth) {}

  void frame(const Frame& frame, const Arrival& arrival, std::span<const double>) override {
    stack.add(arrival.position, frame, window_);
  }
  void evaluated(const Measurement& measurement) override {
    noise = std::min(noise, measurement.picture.noise);
    stack.set_light(measurement.picture.light);
  }

 private:
  Window window_;

 public:
  WindowStack stack;
  double noise = std::numeric_limits<double>::infinity();
};

/// The pixels' noise, and how it is known.
struct Noise {
  double deviation = 0;
  const char* source = "";
};

/// Frames of one place of a live camera tell it; of a recording, what its pictures show; of pictures
/// without any, what rounding to grey levels leaves.
Noise noise_of(Rig& rig, const StackKeeper& kept) {
  if (rig.camera().is_live()) {
    constexpr int kFrames = 5;
    StackKeeper repeated(rig.window(), rig.camera().settings().depth);
    rig.repeat_scatter(kept.stack.positions().back(), kFrames,
                       [&](const Frame& frame, const Arrival& arrival, double) {
                         repeated.frame(frame, arrival, {});
                       });
    const double deviation = repeat_noise(repeated.stack);
    if (deviation > 0) return {deviation, "from repeated frames"};
  } else if (kept.noise > 0 && std::isfinite(kept.noise)) {
    return {kept.noise, "from the least noisy picture"};
  }
  return {std::sqrt(1.0 / 12), "none seen, so what rounding leaves"};
}

RigOptions options_of(const Arguments& arguments) {
  RigOptions options;
  options.rig = rig_of(arguments);
  options.window = arguments.metric.chosen_window();
  options.backend = arguments.metric.backend;
  options.device = arguments.metric.device;
  options.shot.average = checked_average(arguments.average);
  options.shot.stop_requests = stop_requests;
  return options;
}

StackKeeper take_pictures(Rig& rig, const Arguments& arguments) {
  WarningNotes notes;
  SweepView view("pictures", rig.lens().info(), false);
  StackKeeper keeper(rig.window(), rig.camera().settings().depth);
  Observers all({&keeper, &view, &notes});
  Session(rig).sweep({arguments.from, arguments.to, checked_step(arguments.step)}, all);
  return keeper;
}

std::vector<FocusMethod> methods_of(const Arguments& arguments, int n) {
  auto names = arguments.metrics.empty() ? usual_methods() : arguments.metrics;
  if (arguments.metrics.empty() && rings_of_side(n) == 0) std::erase(names, kSpectralMethod);
  std::vector<FocusMethod> methods;
  for (const std::string& name : names) {
    methods.push_back(named_method(name, n, arguments.metric.backend, arguments.metric.device));
  }
  return methods;
}

int run(const Arguments& arguments) {
  require_picture(arguments.plot);
  Rig rig(options_of(arguments));
  const std::string unit = rig.lens().info().unit;
  const std::vector<FocusMethod> methods = methods_of(arguments, rig.window().n);
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  const StackKeeper kept = take_pictures(rig, arguments);
  const Noise noise = noise_of(rig, kept);
  Progress progress;
  const MetricComparison comparison = compare_metrics(
      methods, kept.stack, noise.deviation, [&](std::size_t done, std::size_t total) {
        if (stop_requested()) throw Error(ErrorCode::cancelled, "stopped on request");
        progress.bar("noise", done, total);
      });
  progress.clear();
  const std::string& name = arguments.stack.empty() ? arguments.rig : arguments.stack;
  if (!arguments.plot.empty()) draw(arguments.plot, comparison, name, rig.lens().info());
  if (arguments.json) {
    print_json(comparison, unit);
  } else {
    print_line(fmt::format("{} pictures, window {}, noise of {:.3g} grey levels ({})\n",
                           kept.stack.size(), to_string(rig.window()), noise.deviation,
                           noise.source));
    print_table(comparison, unit);
    print_result(comparison, unit);
  }
  return comparison.doubt ? kNoFocus : kDone;
}

std::string usual_names() {
  std::string names;
  for (const std::string& name : usual_methods()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

}  // namespace

void add_compare_metrics(Verb& program) {
  Verb verb = program.add_verb("compare-metrics", "Run every metric on the same pictures");
  verb.set_footer(
      "Examples:\n  fathom compare-metrics stack.tif --plot metrics.svg\n"
      "  fathom compare-metrics --rig sim:target=usaf,distance=1500 --from 800 --to 1000");
  auto arguments = std::make_shared<Arguments>();
  arguments->metric.device.on_work = patient_words();
  verb.add_option("STACK", arguments->stack,
                  "A folder of pictures or a multi-page TIFF, as replay: takes it");
  add_rig_option(verb, arguments->rig, false);
  verb.add_option("--window", arguments->metric.window,
                  "X,Y,N: left column, top row and side of the window in pixels "
                  "(default: 64 x 64 at the centre)");
  verb.add_option("--metrics", arguments->metrics,
                  "What is compared, without N (default: " + usual_names() + ")")
      .takes_commas();
  verb.add_option("--from", arguments->from, "First lens position (default: the lens's lowest)");
  verb.add_option("--to", arguments->to, "Last lens position (default: the lens's highest)");
  verb.add_option("--step", arguments->step,
                  "Distance between positions (default: all recorded, or some hundred)");
  verb.add_option("--average", arguments->average, "Frames averaged for one picture")
      .shows_default();
  verb.add_option("--backend", arguments->metric.backend, "As fathom devices lists them");
  verb.add_option("--plot", arguments->plot, "FILE.svg or FILE.png: all curves in one picture");
  verb.add_flag("--json", arguments->json,
                "One JSON object a metric on standard output, and one of what they come to");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
