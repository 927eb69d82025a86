// SPDX-License-Identifier: Apache-2.0
// A focus curve in the terminal or as a picture, and other curves as pictures: SVG or PNG.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "focus/focus.hpp"

namespace fathom::cli {

/// Where an axis begins and ends.
struct AxisRange {
  double low, high;
};

/// What stands on the axes and beside the curves.
struct PlotLabels {
  std::string title;
  std::string x;  ///< e.g. "lens position (steps)"
  std::string y;  ///< e.g. "focus quality, fft:64:hann"

  // Of a picture:
  std::string key =
      "bottom center outside horizontal height 1.5";  ///< Where its key stands, as gnuplot says it.
  double highest = 0;  ///< Where its y axis ends; 0 where its curves do.
  std::optional<AxisRange> x_range = std::nullopt;  ///< Else where the curves begin and end.
  std::optional<AxisRange> y_range = std::nullopt;  ///< Else from 0 to `highest`.
  double x_step = 0;  ///< Between numbers on the x axis; 0: as gnuplot likes.
  int width_px = 900, height_px = 540;
  int font_px = 14;
};

enum class CurveStyle {
  line,
  dashed,
  samples,  ///< Points, joined.
  mark,     ///< Points that stand out.
  points,
  error_bars,  ///< Points with their errors.
  band,        ///< Filled, y - error to y + error.
};

/// One of the curves of a picture, in the order in which its points are joined.
struct Curve {
  struct Point {
    double x, y;
    double error = 0;  ///< Half of a bar or a band.
  };
  CurveStyle style = CurveStyle::line;
  std::string title;  ///< Its entry in the key; empty for none.
  std::vector<Point> points;
  std::string colour = "";  ///< Six hexadecimal digits; empty: the style's, or lines take turns.
  int point_type = 7;       ///< Of points and error bars, as gnuplot numbers them; 7 is a disc.
};

/// Curves as the text of an SVG, by gnuplot. Curves without a point are left out. Throws
/// Error(bad_argument) if that leaves none, Error(unavailable) where gnuplot is missing or fails.
std::string svg_curves(std::span<const Curve> curves, const PlotLabels& labels);

/// Writes them to a file, PNG if its name ends in .png, else SVG. Throws as svg_curves, and Error(io)
/// as write_file.
void write_curves(const std::filesystem::path& path, std::span<const Curve> curves,
                  const PlotLabels& labels);

/// The curve in braille dots with axes, `columns` wide, by position; where there is room, an o where
/// something was evaluated. One line where there is no point.
std::string text_plot(std::span<const Evaluation> evaluations, const PlotLabels& labels,
                      int columns);

/// The same as a picture. focus: what a search made of it, drawn too: the fitted shapes, the answer
/// with its sigma, second peaks; null of a sweep, whose highest score is marked. Throws as
/// write_curves.
void write_focus_plot(const std::filesystem::path& path, std::span<const Evaluation> evaluations,
                      const PlotLabels& labels, const Focus* focus);

/// How those who take it describe what plot() draws to.
inline constexpr const char* kPlotHelp =
    "FILE.svg, FILE.png, or - to draw the curve in the terminal";

/// What --plot asks for: "-" draws in the terminal (on stderr where stdout carries JSON), a path
/// writes a picture, empty does nothing.
void plot(const std::string& where, std::span<const Evaluation> evaluations,
          const PlotLabels& labels, bool json, const Focus* focus = nullptr);

/// Whether a file's name is that of a picture that is plotted to: .svg or .png.
bool is_picture(const std::string& where);

/// Throws Error(bad_argument) unless `where` is empty, "-" or ends in .svg or .png: asked before a run,
/// so that a mistyped name costs no measurement.
void require_plot_target(const std::string& where);

/// The first line of a script that draws into this file: SVG or PNG, on white.
std::string gnuplot_terminal(const std::filesystem::path& path, int width_px, int height_px,
                             int font_px);

/// Text between single quotes, which keep gnuplot from interpreting anything in it.
std::string gnuplot_quoted(std::string text);

/// Runs gnuplot on a script and returns what it printed. The script goes through a file, because a
/// pipe in both directions can lock up. Throws Error(unavailable) where gnuplot is missing or
/// fails.
std::string run_gnuplot(const std::string& script);

}  // namespace fathom::cli
