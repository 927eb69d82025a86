// SPDX-License-Identifier: Apache-2.0
// The Walsh-Hadamard kernels in double (thesis eq. 5-2): 16-bit pixels, tapers, `power`. Sums of
// integers below 2^53 are exact in double, so that the scores of untapered windows are exact too.
// 8-bit windows without taper have faster kernels in walsh_integer.cpp. Compiled once per
// instruction set.
//
// Every order has the same coefficients in other places, so they differ in their lever arms only.
//
// Rings are summed coefficient by coefficient: sums of integers below 2^53 (by Cauchy-Schwarz and
// Parseval at most N 2^16 N^2 = 2^43), so that these are exact too.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/walsh_double.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/walsh_double_lanes-inl.h"
#include "backends/cpu/walsh_double_strips-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {
namespace {

template <class Pixel>
Kernel walsh_kernel_of(const MetricSpec& spec) {
  return with_size(spec.n, [&](auto size) {
    using Implementation =
        std::conditional_t<(size < 32), DoubleLanes<size, Pixel>, DoubleStrips<size, Pixel>>;
    return kernel_of<Implementation>(spec.measure);
  });
}

}  // namespace

Kernel walsh_kernel(const MetricSpec& spec, Depth depth) {
  return depth == Depth::bits8 ? walsh_kernel_of<std::uint8_t>(spec)
                               : walsh_kernel_of<std::uint16_t>(spec);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
