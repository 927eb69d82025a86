// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/spectrum_figure.hpp"

#include <fmt/format.h>

#include "engine/file.hpp"
#include "tools/fathom/image_panel.hpp"
#include "tools/fathom/plot.hpp"

namespace fathom::cli {

void write_spectrum_figure(const std::filesystem::path& path, const Frame& frame,
                           const Window& window, const MetricSpec& spec,
                           std::span<const std::complex<double>> coefficients) {
  const PixelPanel pixels{"Window " + to_string(window), window.x, window.y, window.n, window.n};
  write_file(path, run_gnuplot(gnuplot_terminal(path, 1120, 540, 14) +
                               "set multiplot layout 1,2\n" + gnuplot_pixels(pixels, frame) +
                               gnuplot_spectrum("Spectrum, " + spec.text(), spec, coefficients) +
                               "unset multiplot\n"));
}

}  // namespace fathom::cli
