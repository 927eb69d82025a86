// SPDX-License-Identifier: Apache-2.0
// fathom calibrate: learn which lens position means which distance (thesis T14).
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "calibration/calibration.hpp"
#include "calibration/choice.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "session/calibrating.hpp"
#include "session/ranging.hpp"
#include "session/session.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/calibration_view.hpp"
#include "tools/fathom/lens_blur.hpp"
#include "tools/fathom/named_options.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"
#include "tools/fathom/warning_notes.hpp"

namespace fathom::cli {
namespace {

constexpr const char* kAuto = "auto";

struct Arguments {
  RigArguments rig;
  SearchArguments search;
  std::vector<double> distances_mm;
  int repeat = 1;
  std::string model = "inverse";
  std::string from_csv;
  std::string run;
  std::string plot;
};

/// Puts the target where it must be: the rig's own stage, or a person.
void place_target(Rig& rig, double distance_mm) {
  if (rig.stage() != nullptr) return rig.stage()->place_at(distance_mm);
  if (::isatty(STDIN_FILENO) != 1) {
    throw Error(
        ErrorCode::unavailable,
        "this rig cannot move its target and nobody is at the terminal to; focus at each distance "
        "by hand and use --from points.csv");
  }
  note(fmt::format("put the target at {:g} mm from the lens, then press Enter", distance_mm));
  for (int c = std::getchar(); c != '\n'; c = std::getchar()) {
    if (c == EOF) throw Error(ErrorCode::cancelled, "stopped at the prompt");
  }
}

void print_point(double distance_mm, const Focus& focus, const LensInfo& lens, bool json) {
  if (!json) {
    return print_line_on_the_way(
        fmt::format("{:>8g} mm  {}", distance_mm, describe(focus, lens.unit)));
  }
  JsonLine line;
  line.add("distance_mm", distance_mm);
  print_line_on_the_way(add_focus(line, focus, lens).text());
}

/// The model asked for, or with "auto" the one that predicts best, which is then explained.
CalibrationModel model_for(const std::vector<CalibrationPoint>& points,
                           const Arguments& arguments) {
  if (arguments.model != kAuto) return parse_calibration_model(arguments.model);
  const ModelChoice choice = choose_calibration_model(points);
  print_choice(choice, arguments.rig.json);
  return choice.model;
}

void finish(const Calibration& calibration, const Arguments& arguments) {
  write_file(arguments.rig.output, calibration.json());
  print_calibration(calibration, arguments.rig.json);
  plot_calibration(arguments.plot, calibration, arguments.rig.json);
  const std::string saved = "calibration saved to " + arguments.rig.output;
  arguments.rig.json ? note(saved) : print_line(saved);
  note_doubts(calibration);
}

int calibrate_from_csv(const Arguments& arguments) {
  constexpr std::uintmax_t kLargestCsv = 64 << 20;
  const auto points =
      parse_calibration_points(read_file(arguments.from_csv, kLargestCsv), arguments.from_csv);
  finish(Calibration::fit(model_for(points, arguments), points, {}), arguments);
  return kDone;
}

std::vector<CalibrationPoint> measure_points(Rig& rig, const Arguments& arguments,
                                             RunKeeper& keeper) {
  FocusRequest request = arguments.search.request();
  request.returns = true;  // the lens is put back, so a look there costs a picture
  LensBlur blur = lens_blur(rig, request);
  const LensInfo lens = rig.lens().info();
  WarningNotes notes;
  LensReturn put_back(rig.lens(), notes);
  for (const double distance_mm : arguments.distances_mm) {
    place_target(rig, distance_mm);
    keeper.target_at(distance_mm);
    for (int i = 0; i < arguments.repeat; ++i) {
      SearchView view(fmt::format("{:g} mm", distance_mm), lens.unit, false);
      Observers all({&keeper, &view, &notes});
      const Focus focus = *Session(rig).focus(blur.request(), all).focus;
      blur.learn(keeper.file.runs.back());
      print_point(distance_mm, focus, lens, arguments.rig.json);
    }
  }
  return calibration_points(keeper.file.runs);
}

int calibrate_on_rig(const Arguments& arguments) {
  Rig rig(arguments.rig.options());
  RunKeeper keeper = start_run("calibrate", rig);
  RunFile& file = keeper.file;
  const auto measure = [&] {
    const auto points = measure_points(rig, arguments, keeper);
    const std::size_t lost = file.runs.size() - points.size();
    if (lost > 0)
      note(fmt::format("{} of {} runs found no focus and are left out", lost, file.runs.size()));
    file.calibration = fit_calibration(file, model_for(points, arguments));
  };
  with_run_file(file, arguments.run, arguments.rig.json, measure,
                [&] { finish(*file.calibration, arguments); });
  return kDone;
}

std::vector<NamedOption> model_options() {
  std::vector<NamedOption> options;
  for (const CalibrationModel model : calibration_models())
    options.push_back({model.formula().name, model.formula().summary});
  return options;
}

/// What the fit would refuse in the end is refused before anything is measured.
void require_distances(const std::vector<double>& distances_mm, const std::string& model) {
  for (const double distance : distances_mm) {
    if (!(distance > 0 && std::isfinite(distance))) {
      throw Error(ErrorCode::bad_argument, fmt::format("{} mm is not a distance", distance));
    }
  }
  const int needed = model == kAuto ? 3 : parameter_count(parse_calibration_model(model));
  const std::size_t given = std::set<double>(distances_mm.begin(), distances_mm.end()).size();
  if (given >= static_cast<std::size_t>(needed)) return;
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("--model {} needs at least {} distances, better 8; {} determine{} no curve",
                  model, needed, given, given == 1 ? "s" : ""));
}

int run(const Arguments& arguments) {
  require_plot_target(arguments.plot);
  require_separate({arguments.from_csv, arguments.rig.rig},
                   {arguments.rig.output, arguments.run, arguments.plot});
  if (arguments.model != kAuto) parse_calibration_model(arguments.model);
  const bool from_csv = !arguments.from_csv.empty();
  const bool from_rig = !arguments.rig.rig.empty();
  if (from_csv == from_rig) {
    throw Error(ErrorCode::bad_argument,
                "give either --rig with --distances, or --from points.csv");
  }
  if (from_csv) return calibrate_from_csv(arguments);
  if (arguments.distances_mm.empty()) {
    throw Error(ErrorCode::bad_argument,
                "--rig needs --distances, such as --distances 1400,1800,2200,2600");
  }
  if (arguments.repeat < 1) throw Error(ErrorCode::bad_argument, "--repeat takes 1 or more");
  require_distances(arguments.distances_mm, arguments.model);
  return calibrate_on_rig(arguments);
}

}  // namespace

void add_calibrate(Verb& program) {
  Verb verb = program.add_verb("calibrate", "Learn which lens position means which distance");
  verb.set_footer(
      "Examples:\n  fathom calibrate --rig sim --distances 1400,1600,1800,2000,2200,2400,2600 -o "
      "cal.json\n"
      "  fathom calibrate --from points.csv -o cal.json      (columns position, distance_mm)\n"
      "  fathom calibrate --from points.csv --model auto --plot cal.svg -o cal.json");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(verb, "File for the calibration", false).required();
  verb.add_option("--distances", arguments->distances_mm,
                  "Distances of the target, mm, with commas")
      .takes_commas();
  verb.add_option("--repeat", arguments->repeat, "Focus runs at each distance").shows_default();
  verb.add_option(
          "--model", arguments->model,
          fmt::format("Curve to fit: {}, or auto: the one that best predicts distances left out of "
                      "the fit",
                      listed(model_options(), ", ")))
      .shows_default();
  verb.add_option("--from", arguments->from_csv, "CSV of points measured before");
  verb.add_option("--run", arguments->run,
                  "File for the run (default: in ~/.local/state/fathom/runs)");
  verb.add_option("--plot", arguments->plot,
                  "FILE.svg or FILE.png with curve and residuals, or - for the residuals in the "
                  "terminal");
  arguments->search.add_to(verb, false);
  verb.on_run([arguments] { return run(*arguments); });
}

}  // namespace fathom::cli
