// SPDX-License-Identifier: Apache-2.0
// The Fourier kernels: from pixels to the moment of inertia of the spectrum (thesis eqs. 3-10 and
// 5-1), nothing in between leaving the cache. Compiled once per instruction set.
//
// 8-bit pixels are computed in float, and again in double where that shows (Doubt, tables.hpp);
// 16-bit pixels and bands, which may leave out nearly all that a picture holds, in double.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/fourier.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/fourier_lanes-inl.h"
#include "backends/cpu/fourier_strips-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {
namespace {

template <class T, class Pixel>
Kernel fourier_kernel_of(int n) {
  return with_size(n, [](auto size) {
    using Implementation = std::conditional_t<(size < 32), FourierLanes<size, T, Pixel>,
                                              FourierStrips<size, T, Pixel>>;
    return kernel_of<Implementation>();
  });
}

}  // namespace

Kernel fourier_kernel(const MetricSpec& spec, Depth depth) {
  if (depth == Depth::bits16) return fourier_kernel_of<double, std::uint16_t>(spec.n);
  return spec.band ? fourier_kernel_of<double, std::uint8_t>(spec.n)
                   : fourier_kernel_of<float, std::uint8_t>(spec.n);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
