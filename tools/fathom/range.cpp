// SPDX-License-Identifier: Apache-2.0
// fathom range: measure how far away the target is (thesis T15).
#include <algorithm>
#include <cmath>

#include "calibration/range.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "engine/optics.hpp"
#include "session/ranging.hpp"
#include "session/session.hpp"
#include "tools/fathom/aiming.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/lens_blur.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/range_arguments.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_notes.hpp"
#include "words/calibration_words.hpp"
#include "words/verdict_words.hpp"

namespace fathom::cli {
namespace {

using Arguments = RangeArguments;

/// What a range came to: a distance only where every step on the way held.
struct Outcome {
  FocusResult result = FocusResult::no_focus;
  std::vector<Peak> peaks;  ///< Of the runs that focused.
  std::size_t evaluations = 0;
  std::string reason;                 ///< Of the last run that did not focus.
  std::vector<double> lobes;          ///< Positions of its peaks.
  std::optional<Ranged> ranged = {};  ///< Where most runs focused.
};

Calibration load_calibration(const std::string& path) {
  constexpr std::uintmax_t kLargest = 64 << 20;
  return Calibration::parse(read_file(path, kLargest), path);
}

/// Of a window that Fathom chose: another one is no advice, and where it lies says the likeness.
void warn_of_side(const Calibration& calibration, Rig& rig, CalibrationConditions& now) {
  const CalibrationConditions& made = calibration.conditions();
  now.window = made.window;
  const int side = rig.window().n;
  if (made.window.n <= 0 || made.window.n == side) return;
  now.metric = made.metric;
  note(
      fmt::format("the calibration was made with a window of {} px, and the one that was chosen "
                  "has {}: distances may be off, by more than sigma tells; calibrate with such a "
                  "window too",
                  made.window.n, side));
}

/// A curve measured with something else still gives numbers, so it must be said; with another unit
/// it gives nonsense.
void warn_of_differences(const Calibration& calibration, Rig& rig, bool is_chosen) {
  require_unit(calibration, rig.lens().info().unit);
  CalibrationConditions now;
  now.rig = rig.description();
  now.metric = rig.spec().text();
  now.window = rig.window();
  if (is_chosen) warn_of_side(calibration, rig, now);
  for (const CalibrationDoubt& doubt : doubts_of(calibration, now)) note(doubt.text);
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

Outcome measure(Rig& rig, LensBlur& blur, const Arguments& arguments, RunKeeper& keeper) {
  const std::string unit = rig.lens().info().unit;
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  for (int i = 0; i < arguments.repeat; ++i) {
    SearchView view(arguments.repeat > 1 ? fmt::format("run {}", i + 1) : "", unit, false);
    Observers all({&keeper, &view, &notes});
    const Focus focus = *Session(rig).focus(blur.request(), all).focus;
    blur.learn(keeper.file.runs.back());
    if (!arguments.rig.json) print_line_on_the_way(describe(focus, unit));
  }
  return outcome_of(keeper.file.runs);
}

std::optional<optics::DepthOfField> depth_at(const LensInfo& lens, const Distance& distance) {
  if (!lens.optics || !(distance.mm > lens.optics->focal_mm)) return std::nullopt;
  return optics::depth_of_field(*lens.optics, distance.mm);
}

/// As range_of, with the option that helps where the calibration does not reach.
Ranged distance_of(const RunFile& file) {
  try {
    return range_of(file, file.runs);
  } catch (const Error& error) {
    const std::vector<Peak> peaks = focused_peaks(file.runs);
    if (file.extrapolate || file.calibration->covers(mean_position(peaks))) throw;
    throw Error(error.code(), fmt::format("{}, or ask for --extrapolate", error.what()));
  }
}

/// Says what makes this range less sure than the calibration is, and by how much.
void note_strangeness(const Calibration& calibration, const Ranged& ranged, double position) {
  for (const CalibrationDoubt& doubt : doubts_of(calibration, ranged.likeness, position))
    note(doubt.text);
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
void print_json(const Outcome& outcome, const std::optional<Ranged>& ranged,
                std::span<const Run> runs, const RunFile& file) {
  const LensInfo& lens = file.setup.lens;
  JsonLine line;
  line.add("result", to_string(outcome.result));
  if (ranged) {
    const double position = mean_position(outcome.peaks);
    line.add("distance_mm", ranged->distance.mm).add("sigma_mm", ranged->distance.sigma_mm);
    line.add("position", position).add("confidence", least_confidence(runs));
    if (const auto depth = depth_at(lens, ranged->distance))
      line.add("depth_of_field_mm", depth->total_mm());
    if (ranged->likeness.apart) line.add("spectra_apart", *ranged->likeness.apart);
    line.add("unlikeness_sigma_mm", strange_mm(*file.calibration, ranged->likeness, position));
  } else {
    line.add_null("distance_mm").add_null("sigma_mm").add_null("position");
    line.add("lobes", outcome.lobes).add("reason", outcome.reason);
  }
  line.add("evaluations", outcome.evaluations);
  add_journey(line, journey_of(runs)).add_json("foci", foci_json(runs, lens));
  print_line(line.text());
  if (!ranged) note(outcome.reason);
}

/// How far away what the window shows really is, mm.
struct Truth {
  double mean = 0, least = 0, most = 0;
};

/// Of a rig that knows it.
std::optional<Truth> truth_of(Rig& rig) {
  const TargetStage* const stage = rig.stage();
  if (stage == nullptr) return std::nullopt;
  constexpr int kPlaces = 32;
  const Window window = rig.window();
  const double step = 1.0 * window.n / kPlaces;
  Truth truth{.mean = 0, .least = INFINITY, .most = -INFINITY};
  for (int row = 0; row < kPlaces; ++row) {
    for (int column = 0; column < kPlaces; ++column) {
      const double x = window.x + step * (column + 0.5) - 0.5;
      const double y = window.y + step * (row + 0.5) - 0.5;
      const double mm = stage->distance_mm(x, y);
      truth.mean += mm / (kPlaces * kPlaces);
      truth.least = std::min(truth.least, mm);
      truth.most = std::max(truth.most, mm);
    }
  }
  return truth;
}

/// The simulated target's distance, or that of the part of it that the window shows.
void print_truth(const Distance& distance, Rig& rig) {
  const auto truth = truth_of(rig);
  if (!truth) return;
  constexpr double kSame_mm = 0.05;
  const double whole = rig.stage()->distance_mm(), off = distance.mm - truth->mean;
  const bool is_flat = truth->most - truth->least < kSame_mm;
  const bool is_whole = is_flat && std::abs(truth->mean - whole) < kSame_mm;
  print_line(fmt::format(
      "{} {:.1f} mm{}: off by {:+.1f} mm, {:+.2f} %",
      is_whole ? "the simulated target stands at"
               : "what the window shows of the simulated target "
                 "stands at",
      truth->mean,
      is_flat ? "" : fmt::format(" in the mean, {:.1f} to {:.1f} mm", truth->least, truth->most),
      off, 100 * off / truth->mean));
}

void print_text(const Outcome& outcome, const std::optional<Distance>& distance, Rig& rig) {
  const LensInfo lens = rig.lens().info();
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
  print_truth(*distance, rig);
}

/// One distance, from as many focus runs as asked for.
Outcome range_once(Rig& rig, LensBlur& blur, const Arguments& arguments, RunKeeper& keeper) {
  Outcome outcome = measure(rig, blur, arguments, keeper);
  if (outcome.result == FocusResult::focused) {
    outcome.ranged = distance_of(keeper.file);
    keeper.file.distance = outcome.ranged->distance;
  }
  return outcome;
}

void tell_once(const Outcome& outcome, Rig& rig, const Arguments& arguments, const RunFile& file) {
  const LensInfo lens = rig.lens().info();
  plot(arguments.plot, file.runs.back().focus->evaluations,
       {"Ranging with " + arguments.rig.rig, position_label(lens), score_label(rig.spec())},
       arguments.rig.json, &*file.runs.back().focus);
  if (outcome.ranged)
    note_strangeness(*file.calibration, *outcome.ranged, mean_position(outcome.peaks));
  if (arguments.rig.json) return print_json(outcome, outcome.ranged, file.runs, file);
  print_text(outcome, file.distance, rig);
  std::vector<Measurement> all;
  for (const Run& run : file.runs)
    all.insert(all.end(), run.measurements.begin(), run.measurements.end());
  print_line(describe(journey_of(file.runs), time_spent(all), lens.unit));
}

/// The next focus of a target that may have moved.
const Run& follow(Rig& rig, LensBlur& blur, RunKeeper& keeper, Observer& notes) {
  SearchView view("", rig.lens().info().unit, false);
  Observers all({&keeper, &view, &notes});
  const std::vector<Run>& runs = keeper.file.runs;
  if (runs.empty()) {
    Session(rig).focus(blur.request(), all);
    blur.learn(runs.back());
  } else {
    Session(rig).track(runs.back(), all);
  }
  return runs.back();
}

/// The distance of one run, where there is one within the calibration.
std::optional<Ranged> distance_of(const Run& run, const RunFile& file) {
  const Focus& focus = *run.focus;
  if (focus.result() != FocusResult::focused) return std::nullopt;
  if (file.extrapolate || file.calibration->covers(focus.position()))
    return range_of(file, {&run, 1});
  note(fmt::format("the focus at {:.6g} {} lies outside of the calibration", focus.position(),
                   file.setup.lens.unit));
  return std::nullopt;
}

void print_follow(const Run& run, const std::optional<Ranged>& ranged, Rig& rig, bool json,
                  const RunFile& file) {
  const Focus& focus = *run.focus;
  Outcome outcome = outcome_of({&run, 1});
  if (!ranged && focus.result() == FocusResult::focused) {
    outcome.reason = "outside of what was calibrated";
    outcome.lobes = positions_of(focus.lobes);
  }
  if (json) return print_json(outcome, ranged, {&run, 1}, file);
  const auto known = truth_of(rig);
  const std::string truth = known ? fmt::format(", target at {:.1f} mm", known->mean) : "";
  const std::string answer =
      ranged
          ? fmt::format("{:8.1f} mm +- {:.1f} mm", ranged->distance.mm, ranged->distance.sigma_mm)
          : fmt::format("{}: {}", to_string(focus.result()), outcome.reason);
  const double seconds = 1e-9 * static_cast<double>(run.measurements.back().exposure.end_ns);
  print_line(fmt::format("{:8.2f} s  {}, {} evaluations{}", seconds, answer,
                         focus.evaluations.size(), truth));
}

/// Distances one after the other, until as many as asked for, or Ctrl-C, which is no failure here.
/// Whether there was any distance. Every run has its own; the file keeps the foci that they follow
/// from.
bool range_on(Rig& rig, LensBlur& blur, const Arguments& arguments, RunKeeper& keeper) {
  bool any = false;
  const Calibration& calibration = *keeper.file.calibration;
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  std::vector<Run>& runs = keeper.file.runs;
  try {
    for (int i = 0; !arguments.count || i < *arguments.count; ++i) {
      const Run& run = follow(rig, blur, keeper, notes);
      const auto ranged = distance_of(run, keeper.file);
      if (ranged && !any) note_strangeness(calibration, *ranged, run.focus->position());
      print_follow(run, ranged, rig, arguments.rig.json, keeper.file);
      any = any || ranged.has_value();
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::cancelled) throw;
    note("stopped");
    if (!runs.empty() && !runs.back().focus) runs.pop_back();
  }
  return any;
}

int run(const Arguments& arguments) {
  arguments.require_sensible();
  if (arguments.all) return range_all(arguments.request_for_all());
  require_plot_target(arguments.plot);
  require_separate({arguments.rig.rig, arguments.calibration},
                   {arguments.rig.output, arguments.plot});
  const Calibration calibration = load_calibration(arguments.calibration);
  FocusRequest request = arguments.search.request();
  std::optional<Rig> aimed = aimed_rig({.verb = "range",
                                        .rig = arguments.rig,
                                        .from = arguments.search.from,
                                        .to = arguments.search.to,
                                        .blur = request.blur,
                                        .calibration = &calibration,
                                        .unmeasured = {"distance_mm", "sigma_mm", "position"}});
  if (!aimed) return kNoFocus;
  Rig& rig = *aimed;
  warn_of_differences(calibration, rig, chooses_window(arguments.rig));
  // The lens is put back, so a look there costs a picture. What is followed may have moved by then.
  request.returns = !arguments.continuous;
  LensBlur blur = lens_blur(rig, request, &calibration);
  RunKeeper keeper = start_run("range", rig);
  RunFile& file = keeper.file;
  file.calibration = calibration;
  file.extrapolate = arguments.extrapolate;
  if (arguments.continuous) {
    bool any = false;
    const auto measure = [&] { any = range_on(rig, blur, arguments, keeper); };
    with_run_file(file, arguments.rig.output, arguments.rig.json, measure, [] {});
    return any ? kDone : kNoFocus;
  }
  Outcome outcome;
  with_run_file(
      file, arguments.rig.output, arguments.rig.json,
      [&] { outcome = range_once(rig, blur, arguments, keeper); },
      [&] { tell_once(outcome, rig, arguments, file); });
  return file.distance ? kDone : kNoFocus;
}

}  // namespace

void add_range(Verb& program) {
  Verb verb = program.add_verb("range", "Measure how far away the target is");
  verb.set_footer(
      "Examples:\n  fathom range --rig sim:target=seedling,distance=1900 --calibration cal.json "
      "--plot -\n"
      "  fathom range --rig sim:distance=1900 --calibration cal.json --repeat 5 --json\n"
      "  fathom range --rig sim:target=stair --calibration cal.json --window nearest\n"
      "  fathom range --rig sim:target=stair --calibration cal.json --all --from 800 --to 1100\n"
      "  fathom range --rig sim:distance=1500,speed=2 --calibration cal.json --continuous --count "
      "10\n\n"
      "Exit status: 0 a distance, 1 error, 2 wrong usage, 3 no focus found, so no distance.");
  auto arguments = std::make_shared<Arguments>();
  arguments->add_to(verb);
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
