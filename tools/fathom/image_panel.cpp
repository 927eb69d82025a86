// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/image_panel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/spectrum_picture.hpp"
#include "mapping/colour_map.hpp"
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

std::string pixel_rows(const PixelPanel& panel, const Frame& frame) {
  std::string rows;
  for (int y = panel.y; y < panel.y + panel.height_px; ++y) {
    for (int x = panel.x; x < panel.x + panel.width_px; ++x)
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

/// It is as readable in grey and to those who see no red or no green.
std::string viridis_palette() {
  constexpr int kShades = 8;
  std::string shades;
  for (int i = 0; i <= kShades; ++i) {
    const mapping::Rgb rgb = mapping::viridis(static_cast<double>(i) / kShades);
    shades +=
        fmt::format("{}{} '#{:02x}{:02x}{:02x}'", i == 0 ? "" : ", ", i, rgb[0], rgb[1], rgb[2]);
  }
  return shades;
}

/// Units of both axes are equally long, and y grows downwards.
std::string gnuplot_axes(const std::string& title, const std::string& x, const std::string& y,
                         const AxisRange& xs, const AxisRange& ys) {
  return fmt::format(
      "set tics out nomirror\nset size ratio -1\nunset key\n"
      "set title {}\nset xlabel {}\nset ylabel {}\n"
      "set xrange [{:.9g}:{:.9g}]\nset yrange [{:.9g}:{:.9g}]\n",
      gnuplot_quoted(title), gnuplot_quoted(x), gnuplot_quoted(y), xs.low, xs.high, ys.high,
      ys.low);
}

}  // namespace

std::string gnuplot_pixels(const PixelPanel& panel, const Frame& frame) {
  return fmt::format("$pixels << EOD\n{}EOD\n", pixel_rows(panel, frame)) +
         gnuplot_axes(panel.title, "x (px)", "y (px)",
                      {panel.x - 0.5, panel.x + panel.width_px - 0.5},
                      {panel.y - 0.5, panel.y + panel.height_px - 0.5}) +
         "set palette gray\nset cblabel 'grey value'\nset cbrange [*:*]\nplot $pixels with image\n";
}

std::string gnuplot_spectrum(const std::string& title, const MetricSpec& spec,
                             std::span<const std::complex<double>> coefficients) {
  const SpectrumAxes axes = axes_of(spec);
  const double low = axes.first - axes.step / 2;
  const double high = low + axes.step * spec.n;
  return fmt::format("$spectrum << EOD\n{}EOD\n", spectrum_rows(spec, axes, coefficients)) +
         gnuplot_axes(title, fmt::format("horizontal, {}", axes.label),
                      fmt::format("vertical, {}", axes.label), {low, high}, {low, high}) +
         fmt::format(
             "set palette defined ({})\nset cbrange [{}:0]\nset cblabel 'dB below the peak'\n"
             "plot $spectrum with image\n",
             viridis_palette(), -kSpectrumRange_dB);
}

}  // namespace fathom::cli
