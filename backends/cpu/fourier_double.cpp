// SPDX-License-Identifier: Apache-2.0
// The Fourier kernels in double: 16-bit pixels, moments of a band, spectra, and what float is not
// to be trusted with. Compiled once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/fourier_double.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/fourier_lanes-inl.h"
#include "backends/cpu/fourier_strips-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

Kernel fourier_kernel_in_double(int n, Depth depth, Measure measure) {
  return depth == Depth::bits8 ? fourier_kernel_of<double, std::uint8_t>(n, measure)
                               : fourier_kernel_of<double, std::uint16_t>(n, measure);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
