// SPDX-License-Identifier: Apache-2.0
// fathom range: measure how far away the target is (thesis T15).
#include "ranging/range.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/recording.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  SearchArguments search;
  std::string calibration;
  std::string plot;
  int repeat = 1;
  bool extrapolate = false;
};

/// What a range came to: a distance only where every step on the way held.
struct Outcome {
  FocusResult result = FocusResult::no_focus;
  std::vector<Peak> peaks;  ///< Of the runs that focused.
  std::size_t evaluations = 0;
  std::string reason;  ///< Of the last run that did not focus.
};

Calibration load_calibration(const std::string& path) {
  constexpr std::uintmax_t kLargest = 64 << 20;
  return Calibration::parse(read_file(path, kLargest), path);
}

/// A curve measured with something else still gives numbers, so it must be said; with another unit
/// it gives nonsense. What nobody wrote down is not compared.
void warn_of_differences(const Calibration& calibration, Rig& rig) {
  const CalibrationConditions& made = calibration.conditions();
  const LensInfo lens = rig.lens().info();
  if (!made.unit.empty() && made.unit != lens.unit) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("the calibration has positions in {}, this lens counts {}; calibrate "
                            "this rig",
                            made.unit, lens.unit));
  }
  const auto warn = [](const char* what, const std::string& then, const std::string& now,
                       const std::string& advice) {
    if (then.empty() || then == now) return;
    note(fmt::format("the calibration was made with {} {}, this is {}; distances may be off: {}",
                     what, then, now, advice));
  };
  warn("rig", made.rig, rig.camera().description() + "; " + lens.description, "calibrate this rig");
  warn("metric", made.metric, rig.spec().text(),
       fmt::format("use --metric {}, or calibrate again", made.metric));
  const Window window = rig.window();
  const bool place_known = made.window.x != CalibrationConditions::kUnknown;
  if (place_known) {
    warn("window", made.window.n > 0 ? to_string(made.window) : "", to_string(window),
         fmt::format("use --window {}, or calibrate again", to_string(made.window)));
  } else if (made.window.n > 0) {
    warn("a window of side", std::to_string(made.window.n), std::to_string(window.n),
         "use that side, or calibrate again");
  }
}

Outcome measure(Rig& rig, const Arguments& arguments, Record& record) {
  const FocusRequest request = arguments.search.request();
  const std::string unit = rig.lens().info().unit;
  LensReturn put_back(rig.lens());
  Outcome outcome;
  for (int i = 0; i < arguments.repeat; ++i) {
    Focus focus;
    {
      SearchView view(arguments.repeat > 1 ? fmt::format("run {}", i + 1) : "", unit, false);
      focus = search_on_rig(rig, request, record.runs.emplace_back(),
                            [&](const Evaluation& e) { view.show(e); });
    }
    outcome.evaluations += focus.evaluations.size();
    if (focus.result() == FocusResult::focused) {
      outcome.peaks.push_back(focus.peak);
    } else {
      outcome.result = focus.result();
      outcome.reason = focus.verdict.reason;
    }
    if (!arguments.rig.json) print_line(describe(focus, unit));
  }
  // Runs that fail one after the other are no accident, so most of them must agree that there is a
  // focus.
  if (2 * outcome.peaks.size() > static_cast<std::size_t>(arguments.repeat)) {
    outcome.result = FocusResult::focused;
  } else {
    outcome.peaks.clear();
  }
  return outcome;
}

void print_json(const Outcome& outcome, const std::optional<Distance>& distance) {
  JsonLine line;
  line.add("result", to_string(outcome.result));
  if (distance) {
    line.add("distance_mm", distance->mm).add("sigma_mm", distance->sigma_mm);
    line.add("position", mean_position(outcome.peaks));
  } else {
    line.add_null("distance_mm").add_null("sigma_mm").add_null("position");
  }
  print_line(line.add("evaluations", outcome.evaluations).text());
  if (!distance) note(outcome.reason);
}

void print_text(const Outcome& outcome, const std::optional<Distance>& distance,
                TargetStage* stage) {
  if (!distance) {
    return print_line(
        fmt::format("{}: no distance; {}", to_string(outcome.result), outcome.reason));
  }
  print_line(fmt::format("distance {:.1f} mm +- {:.1f} mm (1 sigma, {:.2f} %)", distance->mm,
                         distance->sigma_mm, 100 * distance->sigma_mm / distance->mm));
  if (stage == nullptr) return;
  const double truth = stage->distance_mm();
  print_line(fmt::format("the simulated target stands at {:.1f} mm: off by {:+.1f} mm, {:+.2f} %",
                         truth, distance->mm - truth, 100 * (distance->mm - truth) / truth));
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.rig.rig, arguments.calibration},
                   {arguments.rig.output, arguments.plot});
  if (arguments.repeat < 1) throw Error(ErrorCode::bad_argument, "--repeat takes 1 or more");
  const Calibration calibration = load_calibration(arguments.calibration);
  Rig rig(arguments.rig.options());
  warn_of_differences(calibration, rig);
  const LensInfo lens = rig.lens().info();
  Record record = start_record("range", rig);
  record.calibration = calibration;
  record.extrapolate = arguments.extrapolate;
  with_record(record, arguments.rig.output, arguments.rig.json, [&] {
    const Outcome outcome = measure(rig, arguments, record);
    plot(arguments.plot, record.runs.back().focus->evaluations,
         {"Ranging with " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
         arguments.rig.json);
    if (outcome.result == FocusResult::focused) {
      record.distance =
          range_from_peaks(calibration, outcome.peaks, lens.resolution, arguments.extrapolate);
    }
    if (arguments.rig.json) return print_json(outcome, record.distance);
    print_text(outcome, record.distance, rig.stage());
  });
  return record.distance ? kDone : kNoFocus;
}

}  // namespace

void add_range(CLI::App& app, int& status) {
  auto* const verb = app.add_subcommand("range", "Measure how far away the target is");
  verb->footer(
      "Examples:\n  fathom range --rig sim:target=seedling,distance=1900 --calibration cal.json "
      "--plot -\n"
      "  fathom range --rig sim:distance=1900 --calibration cal.json --repeat 5 --json\n\n"
      "Exit status: 0 a distance, 1 error, 2 wrong usage, 3 no focus found, so no distance.");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(*verb, "File for the record (default: in ~/.local/state/fathom/records)");
  verb->add_option("--calibration", arguments->calibration, "What fathom calibrate made")
      ->required();
  verb->add_option("--repeat", arguments->repeat, "Focus runs whose mean position is used")
      ->capture_default_str();
  verb->add_flag("--extrapolate", arguments->extrapolate,
                 "Allow a distance beyond those that were calibrated");
  arguments->search.add_to(*verb);
  verb->add_option("--plot", arguments->plot, "FILE.svg, or - to draw the curve in the terminal");
  verb->callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace fathom::cli
