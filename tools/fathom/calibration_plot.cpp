// SPDX-License-Identifier: Apache-2.0
// A calibration as two panels of a picture, or its residuals in the terminal.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "tools/fathom/calibration_view.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/palette.hpp"
#include "tools/fathom/plot.hpp"

namespace fathom::cli {
namespace {

constexpr int kSamples = 120;  ///< Of a curve.

/// One row of a gnuplot data block.
template <typename... Numbers>
std::string row(Numbers... numbers) {
  std::string text;
  ((text += fmt::format("{:.10g} ", static_cast<double>(numbers))), ...);
  return text + "\n";
}

/// The curve with its interval: position, distance, low, high; and low and high less the distance.
/// Where the interval has no end, the row is left out and the band ends.
std::string curve_rows(const Calibration& calibration) {
  const double low = calibration.lowest_position(), high = calibration.highest_position();
  std::string rows;
  for (int i = 0; i <= kSamples; ++i) {
    const double position = low + (high - low) * i / kSamples;
    const double mm = calibration.distance_mm(position);
    DistanceInterval interval = calibration.interval(position);
    if (calibration.freedom() < 1) interval = {mm, mm};  // Nothing is known: no band.
    if (!std::isfinite(mm) || !std::isfinite(interval.high_mm)) continue;
    rows += row(position, mm, interval.low_mm, interval.high_mm, interval.low_mm - mm,
                interval.high_mm - mm);
  }
  return rows;
}

/// Position, distance, residual in mm and in the lens's unit of the points that are left out, or of
/// the others.
std::string point_rows(const Calibration& calibration, bool left_out) {
  const auto mm = calibration.residuals_mm(), steps = calibration.position_residuals();
  std::string rows;
  for (std::size_t i = 0; i < mm.size(); ++i) {
    const CalibrationPoint& point = calibration.points()[i];
    if (calibration.left_out(i) != left_out || !std::isfinite(mm[i])) continue;
    rows += row(point.position, point.distance_mm, mm[i], steps[i]);
  }
  return rows;
}

/// How far the residuals' axis reaches: over the band and the points that have a say; an outlier
/// beyond is drawn at the edge.
double residual_reach(const Calibration& calibration) {
  double reach = 0;
  const auto residuals = calibration.residuals_mm();
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const CalibrationPoint& point = calibration.points()[i];
    if (calibration.left_out(i)) continue;
    const DistanceInterval interval = calibration.interval(point.position);
    reach = std::max(reach, std::abs(residuals[i]));
    if (std::isfinite(interval.high_mm)) {
      reach = std::max(reach, interval.high_mm - point.distance_mm);
    }
  }
  return reach > 0 ? 1.15 * reach : 1;
}

std::string gnuplot_script(const std::string& where, const Calibration& calibration) {
  const std::string unit = unit_of(calibration);
  const bool some_left_out = !point_rows(calibration, true).empty();
  const std::string title =
      fmt::format("Calibration, {} model: R^2 = {:.6f}, one position scatters by {:.2g} {}",
                  to_string(calibration.model()), calibration.r_squared(),
                  calibration.position_scatter(), unit);
  const double reach = residual_reach(calibration);
  const bool rises = calibration.slope_mm(calibration.highest_position()) > 0;
  std::string script = gnuplot_terminal(where, 900, 780, 14);
  script += fmt::format(
      "$curve << EOD\n{}EOD\n$kept << EOD\n{}EOD\n$out << EOD\n{}EOD\n"
      "edge = {:.6g}\nclipped(r) = r > edge ? edge : r < -edge ? -edge : r\n"
      "set multiplot\nset border 3\nset tics nomirror\nset grid lc rgb '#{}'\n"
      "set lmargin at screen 0.13\nset rmargin at screen 0.96\n"
      "band = '#{}'; line = '#{}'; mark = '#{}'; gone = '#{}'\n",
      curve_rows(calibration), point_rows(calibration, false), point_rows(calibration, true), reach,
      palette::kGrid, palette::kBlueBand, palette::kBlue, palette::kInk, palette::kVermilion);
  const auto out = [&](const std::string& columns) {
    return some_left_out ? fmt::format(
                               ", $out using {} with points lc rgb gone pt 2 ps 1.2 lw 2 "
                               "title 'left out as an outlier'",
                               columns)
                         : std::string();
  };
  script += fmt::format(
      "set tmargin at screen 0.93\nset bmargin at screen 0.52\nset title {}\n"
      "set xlabel {}\nset ylabel 'distance (mm)'\nset key top {}\n"
      "plot $curve using 1:3:4 with filledcurves lc rgb band title '95 % prediction interval', "
      "$curve using 1:2 with lines lc rgb line lw 1.5 title 'curve', "
      "$kept using 1:2 with points lc rgb mark pt 7 ps 0.7 title 'measured'{}\n",
      gnuplot_quoted(title), gnuplot_quoted(fmt::format("lens position ({})", unit)),
      rises ? "left" : "right", out("1:2"));
  const std::string value =
      some_left_out ? ", $out using 2:(clipped($3)):(sprintf('%+.0f mm', $3)) with labels left "
                      "offset 1,0 tc rgb gone"
                    : "";
  script += fmt::format(
      "set tmargin at screen 0.42\nset bmargin at screen 0.09\nset title\n"
      "set xlabel 'distance (mm)'\nset ylabel 'measured - curve (mm)'\nunset key\n"
      "set yrange [-1.2*edge:1.2*edge]\n"
      "plot $curve using 2:5:6 with filledcurves lc rgb band, "
      "0 with lines lc rgb line lw 1.5, "
      "$kept using 2:3 with points lc rgb mark pt 7 ps 0.7{}\nunset multiplot\n",
      out("2:(clipped($3))") + value);
  return script;
}

/// A row a point: its residual in the lens's unit between the ends of what is 95 % likely.
std::string text_plot(const Calibration& calibration) {
  constexpr int kHalf = 25;  // Characters to either side of 0.
  const auto residuals = calibration.position_residuals();
  double reach = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!calibration.left_out(i)) reach = std::max(reach, std::abs(residuals[i]));
  }
  if (!(reach > 0)) reach = 1;
  std::string text = fmt::format("{:>12}  {:<{}.3g}0{:>{}.3g}   residual of the position, {}\n",
                                 "distance mm", -reach, kHalf, reach, kHalf, unit_of(calibration));
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    std::string line(2 * kHalf + 1, ' ');
    line[kHalf] = '|';
    const double share = std::clamp(residuals[i] / reach, -1.0, 1.0);
    line[static_cast<std::size_t>(kHalf + std::lround(kHalf * share))] =
        calibration.left_out(i) ? 'x' : 'o';
    text += fmt::format("{:>12g}  {}   {:+.2f}{}\n", calibration.points()[i].distance_mm, line,
                        residuals[i], calibration.left_out(i) ? " left out" : "");
  }
  return text;
}

}  // namespace

void plot_calibration(const std::string& where, const Calibration& calibration, bool json) {
  if (where.empty()) return;
  if (where != "-") return write_file(where, run_gnuplot(gnuplot_script(where, calibration)));
  std::fputs(text_plot(calibration).c_str(), json ? stderr : stdout);
}

}  // namespace fathom::cli
