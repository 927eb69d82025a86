// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "tools/fathom/palette.hpp"
#include "tools/fathom/reproduce/figures.hpp"

namespace fathom::reproduce {
namespace {

using cli::CurveStyle;

constexpr const char* kDirect = "direct way to the focus (steps)";

double direct_way(const FocusRun& run) {
  return std::abs(true_position(run.distance_mm) - run.start);
}

cli::Curve costs(const Way& way, const char* title, const char* colour, bool is_time) {
  cli::Curve curve{CurveStyle::points, title, {}, colour};
  for (const FocusRun& run : way.trial.runs)
    curve.points.push_back({direct_way(run), is_time ? run.rig_seconds : run.travel});
  return curve;
}

std::vector<cli::Curve> all_costs(const Ways& ways, bool is_time) {
  const double slope = is_time ? 1.0 / 25 : 1;
  return {
      {CurveStyle::line, "the direct way", {{0, 0}, {1100, slope * 1100}}, cli::palette::kFaint},
      costs(ways.golden, "golden section, told a bracket", kColours[0], is_time),
      costs(ways.coarse, "coarse pass", kColours[1], is_time),
      costs(ways.spectral, "by spectra", kOwnColour, is_time)};
}

cli::Curve right_parts(const Ways& ways, Trial NoiseLevel::*way, const char* title,
                       const char* colour) {
  cli::Curve curve{CurveStyle::samples, title, {}, colour};
  for (const NoiseLevel& level : ways.noise) {
    const Trial& trial = level.*way;
    curve.points.push_back(
        {level.decibels(), 100.0 * right_of(trial) / static_cast<double>(trial.runs.size())});
  }
  return curve;
}

}  // namespace

Figure ways_figure(const Artist& artist, const Ways& ways) {
  cli::PlotLabels travel =
      panel_labels("Travel of the lens", kDirect, "travel (steps)", kKeyBelow, 2);
  cli::PlotLabels time = panel_labels("Time of the rig", kDirect, "time (s)", kKeyBelow, 2);
  travel.x_range = time.x_range = cli::AxisRange{0, 1100};
  return {{artist.draw("ways-travel", "Travel of the lens against the direct way",
                       all_costs(ways, false), travel),
           artist.draw("ways-time", "Time of the rig against the direct way", all_costs(ways, true),
                       time)},
          "Each point is one distance on the chart. No search is below the grey line: the lens "
          "has to get there."};
}

Figure noise_figure(const Artist& artist, const Ways& ways) {
  const std::vector<cli::Curve> curves = {
      right_parts(ways, &NoiseLevel::coarse, "the thesis' metric, coarse pass", kColours[1]),
      right_parts(ways, &NoiseLevel::spectral, "by spectra", kOwnColour),
      {CurveStyle::dashed, "nine of ten", {{0, 90}, {40, 90}}, cli::palette::kFaint}};
  cli::PlotLabels labels{"Right answers against noise", "noise over the rig's (dB)",
                         "right answers (%)", kKeyBelow};
  labels.x_range = {0, 40};
  labels.y_range = {0, 105};
  labels.height_px = 440;
  labels.font_px = 15;
  return {{artist.draw("ways-noise", labels.title, curves, labels)},
          "Right: off by less than half of the depth of field. 20 dB are ten times the noise; the "
          "last point has 96 times the rig's."};
}

}  // namespace fathom::reproduce
