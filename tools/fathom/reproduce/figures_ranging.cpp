// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/fathom/palette.hpp"
#include "tools/fathom/reproduce/figures.hpp"

namespace fathom::reproduce {
namespace {

using cli::CurveStyle;
using Points = std::vector<cli::Curve::Point>;

constexpr const char* kActual = "actual distance (mm)";
/// Sideways, so that marks at one distance do not cover each other: whose they are, which transform.
constexpr double kApartMm = 26, kTransformsApartMm = 9;

cli::PlotLabels panel(const std::string& title, const char* x, const char* y,
                      const char* key = "above right", int beside = 2) {
  return panel_labels(title, x, y, key, beside);
}

cli::Curve half_depth_band() {
  cli::Curve band{CurveStyle::band, "half of the depth of field", {}};
  for (double mm = 1300; mm <= 2700; mm += 50) {
    band.points.push_back({mm, 0, 100 * half_depth_mm(mm) / mm});
  }
  return band;
}

cli::Curve zero_line(double from, double to) {
  return {CurveStyle::line, "", {{from, 0}, {to, 0}}, cli::palette::kFaint};
}

double aside_mm(const TableSet& set) {
  return set.test == 2 ? kTransformsApartMm * (static_cast<double>(set.transform) - 1) : 0;
}

/// Means and 3 sigma of the rows, in per cent of the distance; moved sideways to tell them apart.
Points row_errors(const std::vector<TableSet>& tables, RowOutcome TableRow::*way, double shift) {
  Points points;
  for (const TableSet& set : tables) {
    for (const TableRow& row : set.rows) {
      const Summary summary = (row.*way).summary();
      points.push_back({row.actual_mm + shift + aside_mm(set),
                        100 * (summary.mean / row.actual_mm - 1),
                        300 * summary.sd / row.actual_mm});
    }
  }
  return points;
}

Points thesis_errors(const std::vector<TableSet>& tables, double shift) {
  Points points;
  for (const TableSet& set : tables) {
    for (const TableRow& row : set.rows) {
      points.push_back({row.actual_mm + shift + aside_mm(set),
                        100 * (row.thesis_mm / row.actual_mm - 1),
                        100 * row.thesis_three_sd_mm / row.actual_mm});
    }
  }
  return points;
}

Picture calibration_curve(const Artist& artist, const CalibrationPair& pair, std::size_t t) {
  const ThesisCalibration& thesis = kThesisCalibrations[t];
  cli::Curve line{CurveStyle::line, "fitted curve", {}, cli::palette::kFaint};
  cli::Curve points{CurveStyle::points, "measured", {}, kColours[t]};
  for (const CalibrationPoint& p : points_of(pair.thesis_runs, false)) {
    points.points.push_back({p.position, p.distance_mm});
  }
  for (double p = 510; p <= 1040; p += 10) {
    line.points.push_back({p, pair.thesis_curve.distance_mm(p)});
  }
  const std::string title =
      fmt::format("Figure {}: {}, {} points, R\u00B2 = {:.5f}", thesis.figure,
                  kTransforms[t].short_name, points.points.size(), pair.thesis_curve.r_squared);
  cli::PlotLabels labels = panel(title, "lens position (steps)", "distance (mm)", "top right");
  labels.y_range = {1300, 2700};
  return artist.draw(fmt::format("figure-{}", thesis.figure), title, std::vector{line, points},
                     labels);
}

Picture calibration_residuals(const Artist& artist, const CalibrationPair& pair, std::size_t t) {
  const ThesisCalibration& thesis = kThesisCalibrations[t];
  const auto measured = points_of(pair.thesis_runs, false);
  cli::Curve points{CurveStyle::points, "", {}, kColours[t]};
  for (std::size_t i = 0; i < measured.size(); ++i) {
    points.points.push_back({measured[i].distance_mm, pair.residuals_mm[i]});
  }
  const std::string title = fmt::format("Figure {}: residuals", thesis.figure + 1);
  cli::PlotLabels labels = panel(title, kActual, "actual - curve (mm)");
  labels.x_range = {1300, 2700};
  labels.y_range = {-25, 25};
  return artist.draw(fmt::format("figure-{}", thesis.figure + 1),
                     title + " of " + kTransforms[t].name,
                     std::vector{zero_line(1300, 2700), points}, labels);
}

cli::Curve trial_errors(const Trial& trial, const Calibrations& calibrations, std::size_t t) {
  cli::Curve points{CurveStyle::points, kTransforms[t].short_name, {}, kColours[t]};
  for (const FocusRun& run : trial.runs) {
    if (!run.focused()) continue;
    const double mm = calibrations[t].own->distance_mm(run.position);
    points.points.push_back({run.distance_mm, 100 * (mm / run.distance_mm - 1)});
  }
  return points;
}

cli::Curve evaluations_of(const std::vector<Trial>& trials, const char* title, const char* colour) {
  cli::Curve points{CurveStyle::points, title, {}, colour};
  for (const Trial& trial : trials) {
    for (const FocusRun& run : trial.runs) {
      points.points.push_back({run.distance_mm, static_cast<double>(run.evaluations)});
    }
  }
  return points;
}

}  // namespace

Figure errors_figure(const Artist& artist, const std::vector<TableSet>& tables) {
  const std::vector<cli::Curve> curves = {
      half_depth_band(),
      zero_line(1300, 2700),
      {CurveStyle::error_bars, "the thesis, 1989", thesis_errors(tables, -kApartMm), kThesisColour,
       kDiamond},
      {CurveStyle::error_bars, "the thesis' way, here", row_errors(tables, &TableRow::old_way, 0),
       kColours[0], kDisc},
      {CurveStyle::error_bars, "Fathom's own way, here",
       row_errors(tables, &TableRow::own_way, kApartMm), kOwnColour, kDisc}};
  cli::PlotLabels labels{"Error of every row of tables I and II, with 3 standard deviations",
                         kActual, "measured - actual (% of the distance)", kKeyBelow};
  labels.x_range = {1300, 2700};
  labels.y_range = {-2.6, 2.6};
  labels.font_px = 15;
  return {
      {artist.draw("errors", labels.title, curves, labels)},
      fmt::format(
          "Every row of tables I and II: blue, the thesis' procedure on the simulated rig; grey, "
          "what the thesis measured, drawn {0:g} mm left of its distance; vermilion, Fathom's own "
          "search, fit and curve on the same rig, drawn {0:g} mm right of it; table II's "
          "transforms stand {1:g} mm apart. The seedling's rows lie below zero because its needles "
          "stand in front of the stem that the tape measures to; the two orange rows, at 1864 and "
          "2508 mm, do not.",
          kApartMm, kTransformsApartMm)};
}

Figure calibration_figure(const Artist& artist, const CalibrationPair& pair,
                          std::size_t transform) {
  return {
      {calibration_curve(artist, pair, transform), calibration_residuals(artist, pair, transform)},
      fmt::format("As the thesis' figures {} and {}.", kThesisCalibrations[transform].figure,
                  kThesisCalibrations[transform].figure + 1)};
}

Figure table_figure(const Artist& artist, const TableSet& set) {
  const char* const colour = kColours[set.transform];
  cli::Curve thesis{CurveStyle::points, "thesis, means", {}, kThesisColour, kDiamond};
  cli::Curve ours{CurveStyle::points, "measured here", {}, colour};
  cli::Curve thesis_left{
      CurveStyle::error_bars, "thesis, mean and 3 sd", {}, kThesisColour, kDiamond};
  cli::Curve left{CurveStyle::points, "measured here", {}, colour};
  for (const TableRow& row : set.rows) {
    thesis.points.push_back({row.actual_mm, row.thesis_mm});
    thesis_left.points.push_back({row.actual_mm - kApartMm,
                                  row.thesis_mm - set.thesis.at(row.actual_mm),
                                  row.thesis_three_sd_mm});
    for (const double mm : row.old_way.measured_mm) {
      ours.points.push_back({row.actual_mm, mm});
      left.points.push_back({row.actual_mm, mm - set.old_line.at(row.actual_mm)});
    }
  }
  const Line& line = set.old_line;
  const cli::Curve regression{CurveStyle::line,
                              "regression",
                              {{1300, line.at(1300)}, {2700, line.at(2700)}},
                              cli::palette::kFaint};
  const std::string what = fmt::format("{}, {}", set.object, kTransforms[set.transform].short_name);
  const std::string title = fmt::format("Figure {}: {}", set.figure, what);
  cli::PlotLabels first = panel(title, kActual, "measured distance (mm)", "top left");
  first.x_range = first.y_range = cli::AxisRange{1300, 2700};
  cli::PlotLabels second = panel(fmt::format("Figure {}: off the regression", set.figure + 1),
                                 kActual, "measured - regression (mm)", kKeyBelow);
  second.x_range = {1300, 2700};
  second.y_range = {-40, 40};
  first.height_px = second.height_px = 460;
  return {{artist.draw(fmt::format("figure-{}", set.figure), title,
                       std::vector{regression, thesis, ours}, first),
           artist.draw(fmt::format("figure-{}", set.figure + 1), second.title + ", " + what,
                       std::vector{zero_line(1300, 2700), thesis_left, left}, second)},
          fmt::format(
              "Here: Y = {:.2f} + {:.4f} X, R\u00B2 = {:.5f}, {} points. The thesis: Y = {:g} + "
              "{:g} X, R\u00B2 = {:.4f}, {} points; its means against its own regression (of "
              "which it prints two digits in test 1) are the grey diamonds, drawn {:g} mm left of "
              "their distance.",
              line.intercept, line.slope, line.r_squared, ours.points.size(), set.thesis.intercept,
              set.thesis.slope, set.thesis.r_squared, set.thesis_points(), kApartMm)};
}

Figure seedling_figure(const Artist& artist, const Results& results) {
  std::vector<cli::Curve> curves = {zero_line(1300, 2700)};
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    curves.push_back(trial_errors(results.own.plants[t], results.calibrations, t));
  }
  cli::Curve thesis{CurveStyle::points, "the thesis' seedling", {}, kThesisColour, kDiamond};
  for (const TableSet& set : results.tables) {
    if (set.target != "seedling") continue;
    for (const TableRow& row : set.rows) {
      thesis.points.push_back({row.actual_mm, 100 * (row.thesis_mm / row.actual_mm - 1)});
    }
  }
  curves.push_back(thesis);
  cli::PlotLabels labels{"Seedlings read near", kActual, "measured - actual (% of the distance)",
                         kKeyBelow};
  labels.x_range = {1300, 2700};
  labels.y_range = {-1.2, 0.6};
  labels.height_px = 440;
  labels.font_px = 15;
  return {{artist.draw("seedlings", labels.title, curves, labels)},
          "Each coloured point is another seedling at another distance, measured Fathom's own way; "
          "diamonds are the rows of the thesis' tables."};
}

Figure orange_figure(const Artist& artist, const Orange& orange) {
  Figure figure;
  for (const Orange::Sweep& sweep : orange.sweeps) {
    cli::Curve line{CurveStyle::samples, "", {}, cli::palette::kVermilion};
    for (std::size_t i = 0; i < sweep.positions.size(); ++i) {
      line.points.push_back({sweep.positions[i], sweep.scores[i]});
    }
    const std::string title = fmt::format("Rind in a {0} x {0} window", sweep.side);
    cli::PlotLabels labels =
        panel(title, "lens position (steps)", "focus quality, part of peak", kKeyBelow, 3);
    labels.y_range = {0, 1.05};
    labels.x_step = 200;
    const cli::Curve truth{CurveStyle::dashed,
                           "true focus",
                           {{sweep.truth, 0}, {sweep.truth, 1.05}},
                           cli::palette::kInk};
    figure.pictures.push_back(
        artist.draw(fmt::format("orange-{}", sweep.side), title, std::vector{line, truth}, labels));
  }
  figure.caption =
      "Focus curves of the orange at 1864 mm. The smaller the patch, the less stands above the "
      "noise.";
  return figure;
}

Figure evaluations_figure(const Artist& artist, const Results& results) {
  std::vector<cli::Curve> curves = {
      evaluations_of(results.own.whole, "own way, whole travel", kOwnColour),
      evaluations_of(results.own.working, "own way, told the working range", kColours[2]),
      {CurveStyle::points, "golden section within a bracket", {}, kColours[0]}};
  for (const FocusRun& run : results.searches.bracketed.front().runs) {
    curves.back().points.push_back({run.distance_mm, static_cast<double>(run.evaluations)});
  }
  curves.push_back({CurveStyle::dashed, "thesis: 7 to 11", {{1300, 7}, {2700, 7}}});
  curves.push_back({CurveStyle::dashed, "", {{1300, 11}, {2700, 11}}});
  cli::PlotLabels labels{"Evaluations that one distance takes", kActual, "evaluations", kKeyBelow};
  labels.x_range = {1300, 2700};
  labels.y_range = {0, 22};
  labels.height_px = 440;
  labels.font_px = 15;
  return {{artist.draw("evaluations", labels.title, curves, labels)},
          "Golden section starts from a bracket that somebody gave it; the own way finds the peak "
          "by itself."};
}

Figure own_way_figure(const Artist& artist, const Results& results) {
  std::vector<cli::Curve> curves = {{CurveStyle::band, "0.1 %", {{1300, 0, 0.1}, {2700, 0, 0.1}}},
                                    zero_line(1300, 2700)};
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    curves.push_back(trial_errors(results.own.whole[t], results.calibrations, t));
  }
  cli::PlotLabels labels{"Fathom's own way: error on the chart", kActual,
                         "measured - actual (% of the distance)", kKeyBelow};
  labels.x_range = {1300, 2700};
  labels.y_range = {-0.25, 0.25};
  labels.height_px = 440;
  labels.font_px = 15;
  return {{artist.draw("own-way", labels.title, curves, labels)},
          "Mind the scale: a tenth of the first figure's. Single frames, whole travel."};
}

}  // namespace fathom::reproduce
