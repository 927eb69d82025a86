// SPDX-License-Identifier: Apache-2.0
// fathom range: measure how far away the target is (thesis T15).
#include "calibration/range.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/optics.hpp"
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/verdict_words.hpp"
#include "tools/fathom/warning_words.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  SearchArguments search;
  std::string calibration;
  std::string plot;
  int repeat = 1;
  int count = 0;  ///< Of distances that --continuous gives; 0 for no end.
  bool continuous = false;
  bool extrapolate = false;
};

/// What a range came to: a distance only where every step on the way held.
struct Outcome {
  FocusResult result = FocusResult::no_focus;
  std::vector<Peak> peaks;  ///< Of the runs that focused.
  std::size_t evaluations = 0;
  std::string reason;         ///< Of the last run that did not focus.
  std::vector<double> lobes;  ///< Positions of its peaks.
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
  if (calibration.freedom() < 1)
    note("the calibration has no more points than parameters: sigma says nothing of its error");
  if (calibration.r_squared() < kPoorRSquared)
    note(fmt::format("the calibration fits poorly, R^2 = {:.3f}; calibrate again",
                     calibration.r_squared()));
  const auto warn = [](const char* what, const std::string& then, const std::string& now,
                       const std::string& advice) {
    if (then.empty() || then == now) return;
    note(fmt::format("the calibration was made with {} {}, this is {}; distances may be off: {}",
                     what, then, now, advice));
  };
  warn("rig", made.rig, rig.description(), "calibrate this rig");
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

/// Runs that fail one after the other are no accident, so most of them must agree that there is a
/// focus.
Outcome outcome_of(std::span<const Run> runs) {
  Outcome outcome;
  for (const Run& run : runs) {
    const Focus& focus = *run.focus;
    outcome.evaluations += focus.evaluations.size();
    if (focus.result() == FocusResult::focused) {
      outcome.peaks.push_back(focus.peak);
    } else {
      outcome.result = focus.result();
      outcome.reason = words_for(focus.verdict);
      outcome.lobes = positions_of(focus.lobes);
    }
  }
  if (2 * outcome.peaks.size() > runs.size()) {
    outcome.result = FocusResult::focused;
  } else {
    outcome.peaks.clear();
  }
  return outcome;
}

Outcome measure(Rig& rig, const Arguments& arguments, RunKeeper& keeper) {
  const FocusRequest request = arguments.search.request();
  const std::string unit = rig.lens().info().unit;
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  for (int i = 0; i < arguments.repeat; ++i) {
    SearchView view(arguments.repeat > 1 ? fmt::format("run {}", i + 1) : "", unit, false);
    Observers all({&keeper, &view, &notes});
    const Focus focus = *Session(rig).focus(request, all).focus;
    if (!arguments.rig.json) print_line(describe(focus, unit));
  }
  return outcome_of(keeper.file.runs);
}

std::optional<optics::DepthOfField> depth_at(const LensInfo& lens, const Distance& distance) {
  if (!lens.optics || !(distance.mm > lens.optics->focal_mm)) return std::nullopt;
  return optics::depth_of_field(*lens.optics, distance.mm);
}

/// As range_from_peaks, with the option that helps where the calibration does not reach.
Distance distance_of(const Calibration& calibration, const std::vector<Peak>& peaks,
                     const LensInfo& lens, bool extrapolate) {
  try {
    return range_from_peaks(calibration, peaks, lens.resolution, extrapolate);
  } catch (const Error& error) {
    if (extrapolate || calibration.covers(mean_position(peaks))) throw;
    throw Error(error.code(), fmt::format("{}, or ask for --extrapolate", error.what()));
  }
}

double least_confidence(std::span<const Run> runs) {
  double least = 1;
  for (const Run& run : runs) {
    if (run.focus && run.focus->result() == FocusResult::focused)
      least = std::min(least, run.focus->verdict.confidence);
  }
  return least;
}

/// The foci that a distance follows from.
std::string foci_json(std::span<const Run> runs, const LensInfo& lens) {
  std::string list;
  for (const Run& run : runs) {
    JsonLine focus;
    list += (list.empty() ? "" : ",") + add_focus(focus, *run.focus, lens).text();
  }
  return "[" + list + "]";
}

/// runs: those that the outcome is of.
void print_json(const Outcome& outcome, const std::optional<Distance>& distance,
                std::span<const Run> runs, const LensInfo& lens) {
  JsonLine line;
  line.add("result", to_string(outcome.result));
  if (distance) {
    line.add("distance_mm", distance->mm).add("sigma_mm", distance->sigma_mm);
    line.add("position", mean_position(outcome.peaks)).add("confidence", least_confidence(runs));
    if (const auto depth = depth_at(lens, *distance))
      line.add("depth_of_field_mm", depth->total_mm());
  } else {
    line.add_null("distance_mm").add_null("sigma_mm").add_null("position");
    line.add("lobes", outcome.lobes).add("reason", outcome.reason);
  }
  line.add("evaluations", outcome.evaluations).add_json("foci", foci_json(runs, lens));
  print_line(line.text());
  if (!distance) note(outcome.reason);
}

void print_truth(const Distance& distance, TargetStage* stage) {
  if (stage == nullptr) return;
  const double truth = stage->distance_mm();
  print_line(fmt::format("the simulated target stands at {:.1f} mm: off by {:+.1f} mm, {:+.2f} %",
                         truth, distance.mm - truth, 100 * (distance.mm - truth) / truth));
}

void print_text(const Outcome& outcome, const std::optional<Distance>& distance,
                const LensInfo& lens, TargetStage* stage) {
  if (!distance) {
    return print_line(
        fmt::format("{}: no distance; {}", to_string(outcome.result), outcome.reason));
  }
  print_line(fmt::format("distance {:.1f} mm +- {:.1f} mm (1 sigma, {:.2f} %)", distance->mm,
                         distance->sigma_mm, 100 * distance->sigma_mm / distance->mm));
  if (const auto depth = depth_at(lens, *distance)) {
    print_line(fmt::format("depth of field there: {:.1f} mm, from {:.1f} to {:.1f} mm",
                           depth->total_mm(), depth->near_mm, depth->far_mm));
  }
  print_truth(*distance, stage);
}

/// One distance, from as many focus runs as asked for.
void range_once(Rig& rig, const Arguments& arguments, RunKeeper& keeper) {
  const LensInfo lens = rig.lens().info();
  const Outcome outcome = measure(rig, arguments, keeper);
  RunFile& file = keeper.file;
  plot(arguments.plot, file.runs.back().focus->evaluations,
       {"Ranging with " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
       arguments.rig.json);
  if (outcome.result == FocusResult::focused) {
    file.distance = distance_of(*file.calibration, outcome.peaks, lens, arguments.extrapolate);
  }
  if (arguments.rig.json) return print_json(outcome, file.distance, file.runs, lens);
  print_text(outcome, file.distance, lens, rig.stage());
  std::vector<Measurement> all;
  for (const Run& run : file.runs)
    all.insert(all.end(), run.measurements.begin(), run.measurements.end());
  print_line(describe(time_spent(all)));
}

/// The next focus of a target that may have moved.
const Run& follow(Rig& rig, const Arguments& arguments, RunKeeper& keeper, Observer& notes) {
  SearchView view("", rig.lens().info().unit, false);
  Observers all({&keeper, &view, &notes});
  const std::vector<Run>& runs = keeper.file.runs;
  if (runs.empty()) {
    Session(rig).focus(arguments.search.request(), all);
  } else {
    Session(rig).track(runs.back(), all);
  }
  return runs.back();
}

/// The distance of one focus, where there is one within the calibration.
std::optional<Distance> distance_of(const Focus& focus, const RunFile& file) {
  if (focus.result() != FocusResult::focused) return std::nullopt;
  if (file.extrapolate || file.calibration->covers(focus.position())) {
    return range_from_peaks(*file.calibration, std::vector<Peak>{focus.peak},
                            file.setup.lens.resolution, file.extrapolate);
  }
  note(fmt::format("the focus at {:.6g} {} lies outside of the calibration", focus.position(),
                   file.setup.lens.unit));
  return std::nullopt;
}

void print_follow(const Run& run, const std::optional<Distance>& distance, Rig& rig, bool json) {
  const Focus& focus = *run.focus;
  Outcome outcome = outcome_of({&run, 1});
  if (!distance && focus.result() == FocusResult::focused) {
    outcome.reason = "outside of what was calibrated";
    outcome.lobes = positions_of(focus.lobes);
  }
  if (json) return print_json(outcome, distance, {&run, 1}, rig.lens().info());
  const std::string truth = rig.stage() != nullptr
                                ? fmt::format(", target at {:.1f} mm", rig.stage()->distance_mm())
                                : "";
  const std::string answer =
      distance ? fmt::format("{:8.1f} mm +- {:.1f} mm", distance->mm, distance->sigma_mm)
               : fmt::format("{}: {}", to_string(focus.result()), outcome.reason);
  const double seconds = 1e-9 * static_cast<double>(run.measurements.back().exposure.end_ns);
  print_line(fmt::format("{:8.2f} s  {}, {} evaluations{}", seconds, answer,
                         focus.evaluations.size(), truth));
}

/// Distances one after the other, until as many as asked for, or Ctrl-C, which is no failure here.
/// Whether there was any distance. Every run has its own; the file keeps the foci that they follow
/// from.
bool range_on(Rig& rig, const Arguments& arguments, RunKeeper& keeper) {
  bool any = false;
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  std::vector<Run>& runs = keeper.file.runs;
  try {
    for (int i = 0; arguments.count == 0 || i < arguments.count; ++i) {
      const Run& run = follow(rig, arguments, keeper, notes);
      const auto distance = distance_of(*run.focus, keeper.file);
      print_follow(run, distance, rig, arguments.rig.json);
      any = any || distance.has_value();
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) throw;
    note("stopped");
    if (!runs.empty() && !runs.back().focus) runs.pop_back();
  }
  return any;
}

void require_sensible(const Arguments& arguments) {
  if (arguments.repeat < 1) throw Error(ErrorCode::bad_argument, "--repeat takes 1 or more");
  if (arguments.count < 0) throw Error(ErrorCode::bad_argument, "--count takes 0 (no end) or more");
  if (arguments.count > 0 && !arguments.continuous)
    throw Error(ErrorCode::bad_argument, "--count goes with --continuous");
  if (arguments.continuous && (arguments.repeat > 1 || !arguments.plot.empty())) {
    throw Error(ErrorCode::bad_argument,
                "--continuous gives one distance after the other; leave --repeat and --plot out");
  }
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.rig.rig, arguments.calibration},
                   {arguments.rig.output, arguments.plot});
  require_sensible(arguments);
  const Calibration calibration = load_calibration(arguments.calibration);
  Rig rig(arguments.rig.options());
  warn_of_differences(calibration, rig);
  RunKeeper keeper = start_run("range", rig);
  RunFile& file = keeper.file;
  file.calibration = calibration;
  file.extrapolate = arguments.extrapolate;
  bool any = false;
  with_run_file(file, arguments.rig.output, arguments.rig.json, [&] {
    if (arguments.continuous) {
      any = range_on(rig, arguments, keeper);
    } else {
      range_once(rig, arguments, keeper);
      any = file.distance.has_value();
    }
  });
  return any ? kDone : kNoFocus;
}

}  // namespace

void add_range(Verb& program) {
  Verb verb = program.add_verb("range", "Measure how far away the target is");
  verb.set_footer(
      "Examples:\n  fathom range --rig sim:target=seedling,distance=1900 --calibration cal.json "
      "--plot -\n"
      "  fathom range --rig sim:distance=1900 --calibration cal.json --repeat 5 --json\n"
      "  fathom range --rig sim:distance=1500,speed=2 --calibration cal.json --continuous --count "
      "10\n\n"
      "Exit status: 0 a distance, 1 error, 2 wrong usage, 3 no focus found, so no distance.");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(verb, "File for the run (default: in ~/.local/state/fathom/runs)");
  verb.add_option("--calibration", arguments->calibration, "What fathom calibrate made").required();
  verb.add_option("--repeat", arguments->repeat, "Focus runs whose mean position is used")
      .shows_default();
  verb.add_flag("--continuous", arguments->continuous,
                "Follow a target that moves: one distance after the other, each looked for where "
                "the last one was, until Ctrl-C");
  verb.add_option("--count", arguments->count,
                  "How many distances --continuous gives (default: until Ctrl-C)");
  verb.add_flag("--extrapolate", arguments->extrapolate,
                "Allow a distance beyond those that were calibrated");
  arguments->search.add_to(verb);
  verb.add_option("--plot", arguments->plot, "FILE.svg, or - to draw the curve in the terminal");
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
