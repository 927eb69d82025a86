// SPDX-License-Identifier: Apache-2.0
// A picture with axes, drawn by gnuplot: pixels, or a spectrum over its frequencies.
#pragma once

#include <complex>
#include <span>
#include <string>

#include "engine/frame.hpp"
#include "engine/metric.hpp"
#include "engine/window.hpp"

namespace fathom::cli {

/// Grey values of a rectangle of a frame.
struct PixelPanel {
  std::string title;
  int x = 0, y = 0, width_px = 0, height_px = 0;
};

/// gnuplot's commands that draw these pixels, each over its column and row.
std::string gnuplot_pixels(const PixelPanel& panel, const Frame& frame);

/// The same for a spectrum in dB below its peak, over cycles per pixel (over indices where the
/// transform has no order of frequency). coefficients: as Plan::spectrum gives them.
std::string gnuplot_spectrum(const std::string& title, const MetricSpec& spec,
                             std::span<const std::complex<double>> coefficients);

}  // namespace fathom::cli
