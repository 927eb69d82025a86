// SPDX-License-Identifier: Apache-2.0
// A focus curve in the terminal or as SVG.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "ranging/search.hpp"

namespace fathom::cli {

/// What stands on the axes.
struct PlotLabels {
  std::string title;
  std::string x;  ///< e.g. "lens position (steps)"
  std::string y;  ///< e.g. "focus quality, fft:64:hann"
};

/// The curve in braille dots with axes, `columns` wide, by position. One line where there is no
/// point.
std::string text_plot(std::span<const Evaluation> evaluations, const PlotLabels& labels,
                      int columns);

/// Writes an SVG through gnuplot: the points joined by position, the best one marked. Throws
/// Error(unavailable) where gnuplot is missing or fails, Error(io) as write_file.
void write_svg_plot(const std::filesystem::path& path, std::span<const Evaluation> evaluations,
                    const PlotLabels& labels);

/// What --plot asks for: "-" draws in the terminal (on stderr where stdout carries JSON), a path
/// writes SVG, empty does nothing.
void plot(const std::string& where, std::span<const Evaluation> evaluations,
          const PlotLabels& labels, bool json);

/// Throws Error(bad_argument) unless `where` is empty, "-" or ends in .svg: asked before a run, so
/// that a mistyped name costs no measurement.
void require_plot_target(const std::string& where);

/// Text between single quotes, which keep gnuplot from interpreting anything in it.
std::string gnuplot_quoted(std::string text);

/// Runs gnuplot on a script and returns what it printed. The script goes through a file, because a
/// pipe in both directions can lock up. Throws Error(unavailable) where gnuplot is missing or
/// fails.
std::string run_gnuplot(const std::string& script);

}  // namespace fathom::cli
