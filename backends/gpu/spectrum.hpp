// SPDX-License-Identifier: Apache-2.0
// From what a kernel leaves to the coefficients of Plan::spectrum.
#pragma once

#include <complex>
#include <cstdint>
#include <span>

#include "backends/gpu/shape.hpp"

namespace fathom::gpu {

/// 32-bit words of the storage buffer FATHOM_SPECTRUM, whatever the kernel.
constexpr std::size_t spectrum_words(int n) { return std::size_t{4} * n * n; }

/// raw: what a kernel wrote, in the layout that its head describes; coefficients: [row][column] of
/// Plan::spectrum.
void arrange_spectrum(const MetricSpec& spec, Kernel kernel, Depth depth, const std::uint32_t* raw,
                      std::span<std::complex<double>> coefficients);

}  // namespace fathom::gpu
