// SPDX-License-Identifier: Apache-2.0
// fathom calibrate: learn which lens position means which distance (thesis T14).
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "ranging/calibration.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/recording.hpp"
#include "tools/fathom/search_view.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

struct Arguments {
  RigArguments rig;
  SearchArguments search;
  std::vector<double> distances_mm;
  int repeat = 1;
  std::string model = "inverse";
  std::string from_csv;
  std::string record;
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
    return print_line(fmt::format("{:>8g} mm  {}", distance_mm, describe(focus, lens.unit)));
  }
  JsonLine line;
  line.add("distance_mm", distance_mm);
  print_line(add_focus(line, focus, lens).text());
}

void print_fit(const Calibration& fit, const std::string& path, bool json) {
  if (json) {
    print_line(JsonLine()
                   .add("model", to_string(fit.model()))
                   .add("b0", fit.b0())
                   .add("b1", fit.b1())
                   .add("r_squared", fit.r_squared())
                   .add("points", fit.points().size())
                   .add("position_scatter", fit.position_scatter())
                   .text());
    return note("calibration saved to " + path);
  }
  print_line(fmt::format("\n{:>12}  {:>12}  {:>12}", "position", "distance mm", "residual mm"));
  const auto residuals = fit.residuals_mm();
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    print_line(fmt::format("{:>12g}  {:>12g}  {:>12.2f}", fit.points()[i].position,
                           fit.points()[i].distance_mm, residuals[i]));
  }
  print_line(fmt::format(
      "\ndistance = {:.6g} mm + {:.6g} mm / position, R^2 = {:.6f}, {} points; one "
      "position scatters by {:.2g} about the curve",
      fit.b0(), fit.b1(), fit.r_squared(), fit.points().size(), fit.position_scatter()));
  print_line("calibration saved to " + path);
}

void finish(const Calibration& calibration, const Arguments& arguments) {
  write_file(arguments.rig.output, calibration.json());
  print_fit(calibration, arguments.rig.output, arguments.rig.json);
  constexpr double kPoorFit = 0.95;
  if (calibration.r_squared() < kPoorFit || calibration.b1() < 0) {
    note(fmt::format(
        "this is a poor calibration (R^2 = {:.3f}{}); look at the residuals before using it",
        calibration.r_squared(), calibration.b1() < 0 ? ", distance rises with position" : ""));
  }
  if (calibration.position_scatter() == 0) {
    note(
        "as many points as parameters leave nothing to judge the fit by: its distances will claim "
        "too "
        "small a sigma");
  }
}

int calibrate_from_csv(const Arguments& arguments) {
  constexpr std::uintmax_t kLargestCsv = 64 << 20;
  const auto points =
      parse_calibration_points(read_file(arguments.from_csv, kLargestCsv), arguments.from_csv);
  const CalibrationConditions conditions{"points of " + arguments.from_csv, "", 0, ""};
  finish(Calibration::fit(parse_calibration_model(arguments.model), points, conditions), arguments);
  return kDone;
}

std::vector<CalibrationPoint> measure_points(Rig& rig, const Arguments& arguments, Record& record) {
  const FocusRequest request = arguments.search.request();
  const LensInfo lens = rig.lens().info();
  LensReturn put_back(rig.lens());
  std::vector<CalibrationPoint> points;
  for (const double distance_mm : arguments.distances_mm) {
    place_target(rig, distance_mm);
    for (int i = 0; i < arguments.repeat; ++i) {
      RecordRun& run = record.runs.emplace_back();
      run.target_mm = distance_mm;
      Focus focus;
      {
        SearchView view(fmt::format("{:g} mm", distance_mm), lens.unit, false);
        focus = search_on_rig(rig, request, run, [&](const Evaluation& e) { view.show(e); });
      }
      print_point(distance_mm, focus, lens, arguments.rig.json);
      if (focus.result() == FocusResult::focused) points.push_back({focus.position(), distance_mm});
    }
  }
  return points;
}

int calibrate_on_rig(const Arguments& arguments) {
  const CalibrationModel model = parse_calibration_model(arguments.model);
  Rig rig(arguments.rig.options());
  Record record = start_record("calibrate", rig);
  with_record(record, arguments.record, arguments.rig.json, [&] {
    auto points = measure_points(rig, arguments, record);
    const std::size_t lost = record.runs.size() - points.size();
    if (lost > 0)
      note(fmt::format("{} of {} runs found no focus and are left out", lost, record.runs.size()));
    record.calibration =
        Calibration::fit(model, std::move(points),
                         {rig.camera().description() + "; " + rig.lens().info().description,
                          rig.spec().text(), rig.window().n, rig.lens().info().unit});
    finish(*record.calibration, arguments);
  });
  return kDone;
}

/// What the fit would refuse in the end is refused before anything is measured.
void require_distances(const std::vector<double>& distances_mm) {
  for (const double distance : distances_mm) {
    if (!(distance > 0 && std::isfinite(distance))) {
      throw Error(ErrorCode::bad_argument, fmt::format("{} mm is not a distance", distance));
    }
  }
  if (std::set<double>(distances_mm.begin(), distances_mm.end()).size() < 2) {
    throw Error(ErrorCode::bad_argument,
                "one distance determines no curve; the inverse model has 2 parameters, so give at "
                "least 2 distances, better 8");
  }
}

int run(const Arguments& arguments) {
  require_separate({arguments.from_csv, arguments.rig.rig},
                   {arguments.rig.output, arguments.record});
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
  require_distances(arguments.distances_mm);
  return calibrate_on_rig(arguments);
}

}  // namespace

void add_calibrate(CLI::App& app, int& status) {
  auto* const verb =
      app.add_subcommand("calibrate", "Learn which lens position means which distance");
  verb->footer(
      "Examples:\n  fathom calibrate --rig sim --distances 1400,1600,1800,2000,2200,2400,2600 -o "
      "cal.json\n"
      "  fathom calibrate --from points.csv -o cal.json      (columns position, distance_mm)");
  auto arguments = std::make_shared<Arguments>();
  arguments->rig.add_to(*verb, "File for the calibration", false);
  verb->get_option("--output")->required();
  verb->add_option("--distances", arguments->distances_mm,
                   "Distances of the target, mm, with commas")
      ->delimiter(',');
  verb->add_option("--repeat", arguments->repeat, "Focus runs at each distance")
      ->capture_default_str();
  verb->add_option("--model", arguments->model,
                   "Curve to fit: inverse (distance = b0 + b1 / position)")
      ->capture_default_str();
  verb->add_option("--from", arguments->from_csv, "CSV of points measured before");
  verb->add_option("--record", arguments->record,
                   "File for the record (default: in ~/.local/state/fathom/records)");
  arguments->search.add_to(*verb, false);
  verb->callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace fathom::cli
