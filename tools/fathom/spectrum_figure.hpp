// SPDX-License-Identifier: Apache-2.0
// A window and its spectrum side by side, with axes, as a picture.
#pragma once

#include <complex>
#include <filesystem>
#include <span>

#include "engine/frame.hpp"
#include "engine/metric.hpp"
#include "engine/window.hpp"

namespace fathom::cli {

/// Writes SVG or PNG, as the name says: the window's pixels, and its spectrum in dB below its peak
/// over cycles per pixel (over indices where the transform has no order of frequency). coefficients:
/// as Plan::spectrum gives them. Throws Error(unavailable) without gnuplot, Error(io) as write_file.
void write_spectrum_figure(const std::filesystem::path& path, const Frame& frame,
                           const Window& window, const MetricSpec& spec,
                           std::span<const std::complex<double>> coefficients);

}  // namespace fathom::cli
