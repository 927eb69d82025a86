// SPDX-License-Identifier: Apache-2.0
// The cosine kernels, in double: an entropy has a term of every coefficient, most of which are so
// small that float would leave nothing but noise of them. Compiled once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/cosine.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/cosine-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {
namespace {

template <class Pixel>
Kernel cosine_kernel_of(const MetricSpec& spec) {
  return with_size(spec.n,
                   [&](auto size) { return kernel_of<CosineStrips<size, Pixel>>(spec.measure); });
}

}  // namespace

Kernel cosine_kernel(const MetricSpec& spec, Depth depth) {
  return depth == Depth::bits8 ? cosine_kernel_of<std::uint8_t>(spec)
                               : cosine_kernel_of<std::uint16_t>(spec);
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
