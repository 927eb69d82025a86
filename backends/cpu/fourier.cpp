// SPDX-License-Identifier: Apache-2.0
// The Fourier kernels: from pixels to the moment of inertia of the spectrum (thesis eqs. 3-10 and
// 5-1), nothing in between leaving the cache. Compiled once per instruction set.
//
// 8-bit pixels are computed in float, and again in double where that shows (fourier-inl.h,
// "Doubt"); 16-bit pixels and bands, which may leave out nearly all that a picture holds, in
// double.
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

template <int N, class T, class Pixel>
Kernel kernel_of() {
  using Implementation =
      std::conditional_t<(N < 32), FourierLanes<N, T, Pixel>, FourierStrips<N, T, Pixel>>;
  return {&Implementation::score, &Implementation::spectrum, Implementation::kScratchBytes};
}

template <class T, class Pixel>
Kernel kernel_of(int n) {
  switch (n) {
    case 8:
      return kernel_of<8, T, Pixel>();
    case 16:
      return kernel_of<16, T, Pixel>();
    case 32:
      return kernel_of<32, T, Pixel>();
    case 64:
      return kernel_of<64, T, Pixel>();
    case 128:
      return kernel_of<128, T, Pixel>();
    case 256:
      return kernel_of<256, T, Pixel>();
    default:
      return kernel_of<512, T, Pixel>();
  }
}

}  // namespace

Kernel fourier_kernel(const MetricSpec& spec, Depth depth) {
  if (depth == Depth::bits16) return kernel_of<double, std::uint16_t>(spec.n);
  return spec.band ? kernel_of<double, std::uint8_t>(spec.n)
                   : kernel_of<float, std::uint8_t>(spec.n);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
