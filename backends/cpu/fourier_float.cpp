// SPDX-License-Identifier: Apache-2.0
// The Fourier kernels in float, for 8-bit pixels: from pixels to the moment of inertia of the
// spectrum (thesis eqs. 3-10 and 5-1) or to its rings, nothing in between leaving the cache.
// Compiled once per instruction set. What float is not to be trusted with is computed again in
// double (Doubt, tables.hpp; RingDoubt, ring_tables.hpp).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/fourier_float.cpp"
#include "backends/cpu/targets.hpp"
// After targets.hpp, which says which instruction sets there are.
#include <hwy/foreach_target.h>

#include "backends/cpu/fourier_lanes-inl.h"
#include "backends/cpu/fourier_strips-inl.h"

HWY_BEFORE_NAMESPACE();
namespace fathom::cpu::HWY_NAMESPACE {
namespace {

/// Whether float meets the tolerance. A band may leave out nearly all that a picture holds, and a
/// moment does not show it; a ring does.
bool fits_float(const MetricSpec& spec, Depth depth) {
  if (depth == Depth::bits16) return false;
  switch (spec.measure) {
    case Measure::moment:
      return !spec.band;
    case Measure::rings:
      return true;
    case Measure::entropy:
      break;  // of no Fourier transform
  }
  return false;
}

}  // namespace

Kernel fourier_kernel(const MetricSpec& spec, Depth depth) {
  const Kernel in_double = fourier_kernel_in_double(spec.n, depth, spec.measure);
  if (!fits_float(spec, depth)) return in_double;
  Kernel kernel = fourier_kernel_of<float, std::uint8_t>(spec.n, spec.measure);
  // It hands its scratch memory on to its counterpart in double.
  kernel.scratch_bytes = std::max(kernel.scratch_bytes, in_double.scratch_bytes);
  return kernel;
}

}  // namespace fathom::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
