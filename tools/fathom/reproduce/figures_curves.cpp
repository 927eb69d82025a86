// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"
#include "tools/fathom/palette.hpp"
#include "tools/fathom/reproduce/figures.hpp"

namespace fathom::reproduce {
namespace {

using Points = std::vector<cli::Curve::Point>;

constexpr const char* kPosition = "lens position (steps)";
constexpr const char* kScore = "focus quality, part of peak";

cli::PlotLabels panel(const std::string& title, const char* x, const char* y,
                      const char* key = "above right", int beside = 2) {
  return panel_labels(title, x, y, key, beside);
}

cli::Curve focus_curve(const MeasuredCurves& curve, std::size_t t, cli::CurveStyle style) {
  cli::Curve line{style, kTransforms[t].short_name, {}, kColours[t]};
  for (std::size_t i = 0; i < curve.positions.size(); ++i) {
    line.points.push_back({curve.positions[i], curve.scores[i][t]});
  }
  return line;
}

std::vector<cli::Curve> focus_curves(const MeasuredCurves& curve,
                                     std::initializer_list<std::size_t> transforms,
                                     cli::CurveStyle style = cli::CurveStyle::line) {
  std::vector<cli::Curve> lines;
  for (const std::size_t t : transforms) lines.push_back(focus_curve(curve, t, style));
  return lines;
}

cli::Curve upright(double x, double top, const char* title) {
  return {cli::CurveStyle::dashed, title, {{x, 0}, {x, top}}, cli::palette::kInk};
}

/// A reading as its deviation from the mean, in per cent.
Points deviations(const Readings& readings, std::size_t t) {
  const double mean = readings.of(t).mean;
  Points points;
  for (std::size_t i = 0; i < readings.scores.size(); ++i) {
    const double shift = 0.25 * (static_cast<double>(t) - 1);
    points.push_back(
        {static_cast<double>(i) + 1 + shift, 100 * (readings.scores[i][t] / mean - 1)});
  }
  return points;
}

Picture readings_picture(const Artist& artist, const Readings& readings, const std::string& file,
                         const std::string& title, double thesis_percent, double reach) {
  const double last = static_cast<double>(readings.scores.size()) + 1;
  std::vector<cli::Curve> curves;
  if (thesis_percent > 0) {
    curves.push_back({cli::CurveStyle::band,
                      fmt::format("thesis: within {:g} %", thesis_percent),
                      {{0, 0, thesis_percent}, {last, 0, thesis_percent}}});
  }
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    curves.push_back(
        {cli::CurveStyle::points, kTransforms[t].short_name, deviations(readings, t), kColours[t]});
  }
  cli::PlotLabels labels = panel(title, "reading", "off the mean (%)", kKeyBelow, 3);
  labels.x_range = {0, last};
  labels.y_range = {-reach, reach};
  labels.height_px = 520;
  return artist.draw(file, title, curves, labels);
}

}  // namespace

cli::PlotLabels panel_labels(const std::string& title, const std::string& x, const std::string& y,
                             const char* key, int beside) {
  cli::PlotLabels labels{title, x, y, key};
  labels.width_px = beside == 1 ? 900 : beside == 2 ? 560 : 480;
  labels.height_px = beside == 1 ? 500 : 420;
  labels.font_px = beside == 1 ? 15 : 16;
  return labels;
}

Artist::Artist() {
  try {
    cli::run_gnuplot("set terminal svg\nplot 0\n");
  } catch (const Error& error) {
    problem_ = error.what();
  }
}

Picture Artist::draw(const std::string& file, const std::string& description,
                     std::span<const cli::Curve> curves, const cli::PlotLabels& labels) const {
  return {file, description, problem_.empty() ? cli::svg_curves(curves, labels) : std::string()};
}

Picture Artist::draw_script(const std::string& file, const std::string& description, int width_px,
                            int height_px, int font_px, const std::string& commands) const {
  if (!problem_.empty()) return {file, description, {}};
  return {file, description,
          cli::run_gnuplot(cli::gnuplot_terminal(file + ".svg", width_px, height_px, font_px) +
                           commands)};
}

Figure curves_figure_11_12(const Artist& artist, const Curves& curves) {
  const MeasuredCurves& curve = curves.curves[1];
  const std::string at = fmt::format(", target at {:g} mm", curve.distance_mm);
  Figure figure;
  figure.pictures.push_back(
      artist.draw("figure-11", "FFT and normal Walsh" + at, focus_curves(curve, {kFft, kPaley}),
                  panel("Figure 11: FFT and normal Walsh" + at, kPosition, kScore, "top left")));
  figure.pictures.push_back(artist.draw(
      "figure-12", "normal and sequency Walsh" + at, focus_curves(curve, {kPaley, kSequency}),
      panel("Figure 12: normal and sequency Walsh" + at, kPosition, kScore, "top left")));
  figure.caption =
      "As the thesis' figures 11 and 12. The two Walsh orders lie nearly on each other.";
  return figure;
}

Figure curves_figure_13(const Artist& artist, const Curves& curves) {
  Figure figure;
  for (const MeasuredCurves& curve : curves.curves) {
    auto lines = focus_curves(curve, {kFft, kPaley, kSequency});
    lines.push_back(upright(curve.truth, 1, "true focus"));
    const std::string title = fmt::format("Figure 13: target at {:g} mm", curve.distance_mm);
    cli::PlotLabels labels = panel(title, kPosition, kScore, kKeyBelow, 3);
    labels.height_px = 500;
    figure.pictures.push_back(
        artist.draw(fmt::format("figure-13-{:g}mm", curve.distance_mm), title, lines, labels));
  }
  figure.caption =
      "All three transforms over the whole travel, as the thesis' figure 13. The dashed line is "
      "where "
      "the geometry of the lens says the focus is.";
  return figure;
}

Figure curves_close_up(const Artist& artist, const Curves& curves) {
  const MeasuredCurves& curve = curves.curves[1];
  auto near = focus_curves(curve, {kFft, kPaley, kSequency}, cli::CurveStyle::samples);
  near.push_back(upright(curve.truth, 1.05, "true focus"));
  cli::PlotLabels top = panel("The peak, enlarged", kPosition, kScore, kKeyBelow);
  top.x_range = {std::round(curve.truth) - 60, std::round(curve.truth) + 60};
  top.y_range = {0, 1.05};
  top.height_px = 480;
  cli::PlotLabels floor = panel("The floor, enlarged", kPosition, kScore, kKeyBelow);
  floor.x_range = {0, 1200};
  floor.y_range = {0.04, 0.2};
  floor.height_px = 480;
  Figure figure;
  figure.pictures.push_back(artist.draw("figure-13-peak",
                                        "the peak of the curves at 2000 mm, "
                                        "enlarged",
                                        near, top));
  figure.pictures.push_back(artist.draw("figure-13-floor",
                                        "the floor of the curves at 2000 mm, enlarged",
                                        focus_curves(curve, {kFft, kPaley, kSequency}), floor));
  figure.caption =
      "The curves at 2000 mm, enlarged. Left: the same top for all three; the FFT's peak is the "
      "narrowest. Right: far from focus the FFT's line is the rough one.";
  return figure;
}

Figure far_figure(const Artist& artist, const Curves& curves) {
  Figure figure;
  const auto picture = [&](ThreeNumbers FarFloor::*which, const char* file, const char* title,
                           const char* y) {
    std::vector<cli::Curve> marks;
    for (std::size_t t = 0; t < kTransformCount; ++t) {
      cli::Curve mark{cli::CurveStyle::points, kTransforms[t].short_name, {}, kColours[t]};
      for (std::size_t i = 0; i < curves.floors.size(); ++i) {
        const FarFloor& floor = curves.floors[i];
        const double shift = 40 * (static_cast<double>(t) - 1) +
                             (floor.target == "usaf" ? -110.0 : 110.0) +
                             5 * static_cast<double>(i % 4);
        mark.points.push_back({floor.distance_mm + shift, 100 * (floor.*which)[t]});
      }
      marks.push_back(mark);
    }
    cli::PlotLabels labels =
        panel(title, "target distance (mm); chart left, seedling right", y, kKeyBelow);
    labels.x_range = {1250, 2750};
    labels.x_step = 500;
    labels.height_px = 480;
    return artist.draw(file, title, marks, labels);
  };
  figure.pictures.push_back(picture(&FarFloor::of_peak, "far-of-peak",
                                    "Roughness far from focus, part of the peak",
                                    "roughness (% of the peak)"));
  figure.pictures.push_back(picture(&FarFloor::of_level, "far-of-level",
                                    "The same, part of the local level",
                                    "roughness (% of the level)"));
  figure.caption =
      "Each point is one rig with its own noise. Beside each distance: chart to the left, seedling "
      "to "
      "the right.";
  return figure;
}

Figure repeatability_figure(const Artist& artist, const Repeatability& repeatability) {
  constexpr double kAt = 2000;
  Figure figure;
  figure.pictures.push_back(readings_picture(artist, repeatability.find(kAt, false, 1),
                                             "repeat-1-frame", "In focus, one frame", 2, 3));
  figure.pictures.push_back(readings_picture(artist, repeatability.find(kAt, false, kManyFrames),
                                             "repeat-10-frames", "In focus, mean of ten frames",
                                             1.5, 3));
  figure.pictures.push_back(readings_picture(artist, repeatability.find(kAt, true, 1), "repeat-far",
                                             "300 steps from focus, one frame", 0, 10));
  figure.caption =
      "Readings of the chart at 2000 mm, a minute apart. In focus, the slow wave that all share is "
      "the "
      "lamp: averaging does not remove it. Far from focus, mind the other scale.";
  return figure;
}

}  // namespace fathom::reproduce
