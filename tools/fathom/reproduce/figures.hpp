// SPDX-License-Identifier: Apache-2.0
// The report's plots. The three transforms have the same colours everywhere.
#pragma once

#include <span>

#include "tools/fathom/palette.hpp"
#include "tools/fathom/plot.hpp"
#include "tools/fathom/reproduce/document.hpp"
#include "tools/fathom/reproduce/results.hpp"

namespace fathom::reproduce {

inline constexpr const char* kColours[kTransformCount] = {
    cli::palette::kBlue, cli::palette::kOrange, cli::palette::kGreen};
inline constexpr const char* kThesisColour = cli::palette::kSoft;
inline constexpr const char* kOwnColour = cli::palette::kVermilion;
/// Where a key stands that must not hide points; the height keeps it off the axis' label.
inline constexpr const char* kKeyBelow = "below height 1.2";
inline constexpr int kDiamond = 13, kDisc = 7;  // gnuplot's point types

/// Labels of one of several pictures side by side: large enough letters on a phone too.
cli::PlotLabels panel_labels(const std::string& title, const std::string& x, const std::string& y,
                             const char* key, int beside);

/// Draws with gnuplot, or gives pictures without a plot where there is none.
class Artist {
 public:
  Artist();

  /// Why there is no gnuplot; empty where there is one.
  const std::string& problem() const { return problem_; }
  Picture draw(const std::string& file, const std::string& description,
               std::span<const cli::Curve> curves, const cli::PlotLabels& labels) const;
  /// The same by commands of gnuplot.
  Picture draw_script(const std::string& file, const std::string& description, int width_px,
                      int height_px, int font_px, const std::string& commands) const;

 private:
  std::string problem_;
};

/// Errors of all rows of both tables: the thesis', the thesis' way here, Fathom's own way.
Figure errors_figure(const Artist& artist, const std::vector<TableSet>& tables);

Figure targets_figure(const Artist& artist, const Looks& looks, bool sharp);
/// The chart's window and its spectra.
Figure spectra_figure(const Artist& artist, const Looks& looks, bool sharp);
/// Where in the spectra the scores lie.
Figure sums_figure(const Artist& artist, const Looks& looks);
Figure curves_figure_11_12(const Artist& artist, const Curves& curves);
Figure curves_figure_13(const Artist& artist, const Curves& curves);
Figure curves_close_up(const Artist& artist, const Curves& curves);
Figure far_figure(const Artist& artist, const Curves& curves);
Figure repeatability_figure(const Artist& artist, const Repeatability& repeatability);

Figure calibration_figure(const Artist& artist, const CalibrationPair& pair, std::size_t transform);
Figure table_figure(const Artist& artist, const TableSet& set);
Figure seedling_figure(const Artist& artist, const Results& results);
Figure orange_figure(const Artist& artist, const Orange& orange);
Figure evaluations_figure(const Artist& artist, const Results& results);
Figure own_way_figure(const Artist& artist, const Results& results);
Figure ways_figure(const Artist& artist, const Ways& ways);
Figure noise_figure(const Artist& artist, const Ways& ways);

}  // namespace fathom::reproduce
