// SPDX-License-Identifier: Apache-2.0
// The Walsh-Hadamard kernels for 8-bit windows without taper and `power` (thesis eq. 5-2): integers
// as narrow as they can be. Compiled once per instruction set.
//
// A transform of N x N pixels is 2 log2 N stages of sums and differences, in any order. Pixels
// taken about the middle of their range (which changes T(0, 0) only, and that has no lever arm)
// need 16 bits for eight stages, so that the first eight run on 16-bit lanes and the rest on 32-bit
// ones. What lies in the lanes differs with N: windows, blocks of windows, or a part of one.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/walsh_integer.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/walsh_integer_blocks-inl.h"
#include "backends/cpu/walsh_integer_lanes-inl.h"
#include "backends/cpu/walsh_integer_strips-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {

Kernel integer_walsh_kernel(const MetricSpec& spec) {
  return with_size(spec.n, [&](auto size) {
    if constexpr (size <= 16) {
      return kernel_of<IntegerLanes<size>>(spec.measure);
    } else if constexpr (size <= 64) {
      return kernel_of<IntegerBlocks<size>>(spec.measure);
    } else {
      return kernel_of<IntegerStrips<size>>(spec.measure);
    }
  });
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
