// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/spectrum_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/file.hpp"
#include "engine/spectrum_picture.hpp"
#include "tools/fathom/plot.hpp"

namespace fathom::cli {
namespace {

/// From coefficient (column, row) to what its axis says.
struct SpectrumAxes {
  double first = 0;  ///< Of column and row 0.
  double step = 1;
  const char* label = "index";
};

SpectrumAxes axes_of(const MetricSpec& spec) {
  const std::optional<double> cycles = cycles_per_index(spec.transform);
  if (!cycles) return {};
  const double step = *cycles / spec.n;
  const bool is_centred = family_of(spec.transform) == TransformFamily::fourier;
  return {is_centred ? -0.5 : 0, step, "cycles per pixel"};
}

std::string window_rows(const Frame& frame, const Window& window) {
  std::string rows;
  for (int y = window.y; y < window.y + window.n; ++y) {
    for (int x = window.x; x < window.x + window.n; ++x)
      rows += fmt::format("{} {} {}\n", x, y, frame.at(x, y));
  }
  return rows;
}

std::string spectrum_rows(const MetricSpec& spec, const SpectrumAxes& axes,
                          std::span<const std::complex<double>> coefficients) {
  double largest = 0;
  for (const std::complex<double>& c : coefficients) largest = std::max(largest, std::abs(c));
  std::string rows;
  for (int row = 0; row < spec.n; ++row) {
    for (int column = 0; column < spec.n; ++column) {
      const double part =
          largest > 0
              ? std::abs(coefficients[static_cast<std::size_t>(row) * spec.n + column]) / largest
              : 0;
      const double level = part > 0 ? 20 * std::log10(part) : -kSpectrumRange_dB;
      rows += fmt::format("{:.6g} {:.6g} {:.4g}\n", axes.first + axes.step * column,
                          axes.first + axes.step * row, std::max(level, -kSpectrumRange_dB));
    }
  }
  return rows;
}

std::string script_of(const std::filesystem::path& path, const Frame& frame, const Window& window,
                      const MetricSpec& spec, std::span<const std::complex<double>> coefficients) {
  const SpectrumAxes axes = axes_of(spec);
  const double low = axes.first - axes.step / 2;
  const double high = low + axes.step * spec.n;
  // The palette (viridis) is as readable in grey and to those who see no red or no green.
  return gnuplot_terminal(path, 1120, 540, 14) +
         fmt::format(
             "$window << EOD\n{}EOD\n$spectrum << EOD\n{}EOD\n"
             "set multiplot layout 1,2\nset tics out nomirror\nset size square\nunset key\n"
             "set title {}\nset xlabel 'x (px)'\nset ylabel 'y (px)'\n"
             "set xrange [{}:{}]\nset yrange [{}:{}]\nset palette gray\nset cblabel 'grey value'\n"
             "plot $window with image\n",
             window_rows(frame, window), spectrum_rows(spec, axes, coefficients),
             gnuplot_quoted("Window " + to_string(window)), window.x - 0.5,
             window.x + window.n - 0.5, window.y + window.n - 0.5, window.y - 0.5) +
         fmt::format(
             "set title {}\nset xlabel 'horizontal, {}'\nset ylabel 'vertical, {}'\n"
             "set xrange [{:.9g}:{:.9g}]\nset yrange [{:.9g}:{:.9g}]\n"
             "set palette defined (0 '#440154', 1 '#414487', 2 '#2a788e', 3 '#22a884', "
             "4 '#7ad151', 5 '#fde725')\nset cbrange [{}:0]\nset cblabel 'dB below the peak'\n"
             "plot $spectrum with image\nunset multiplot\n",
             gnuplot_quoted("Spectrum, " + spec.text()), axes.label, axes.label, low, high, high,
             low, -kSpectrumRange_dB);
}

}  // namespace

void write_spectrum_figure(const std::filesystem::path& path, const Frame& frame,
                           const Window& window, const MetricSpec& spec,
                           std::span<const std::complex<double>> coefficients) {
  write_file(path, run_gnuplot(script_of(path, frame, window, spec, coefficients)));
}

}  // namespace fathom::cli
