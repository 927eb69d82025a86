// SPDX-License-Identifier: Apache-2.0
// What stands between the cpu backend and the code that is compiled once per instruction set.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "backends/cpu/tables.hpp"
#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::cpu {

/// Most windows that a kernel scores at once. Small windows lie side by side in the lanes of one
/// register, so that a full block costs little more than one window.
inline constexpr int kBlock = 16;

// Which kernel computes what:
//
//   metric                      N          in             class          file
//   fft, 8 bits: rings, or      8, 16      float *        FourierLanes   fourier_lanes-inl.h
//   moments without a band      32 .. 512  float *        FourierStrips  fourier_strips-inl.h
//   fft, all others             as above   double         as above
//   walsh-*, 8 bits, no taper,  8, 16      16, 32 bits    IntegerLanes   walsh_integer_lanes-inl.h
//   no `power`                  32, 64     16, 32 bits    IntegerBlocks  walsh_integer_blocks-inl.h
//                               128 ..     16, 32 bits    IntegerStrips  walsh_integer_strips-inl.h
//   walsh-*, all others         8, 16      double         DoubleLanes    walsh_double_lanes-inl.h
//                               32 .. 512  double         DoubleStrips   walsh_double_strips-inl.h
//   dct                         8 .. 512   double         CosineStrips   cosine-inl.h
//
//   * and again in double where Doubt (tables.hpp) or RingDoubt (ring_tables.hpp) does not trust
//   float; Plan::spectrum always in double
//
// Lanes: a lane is a window. Blocks: 128 bits are a window. Strips: one window at a time, lanes are
// neighbouring columns, then neighbouring rows of coefficients.

/// One kernel: a measure of a transform of one size on pixels of one depth.
struct Kernel {
  /// Measures at most kBlock windows: spec.outputs() values of each, window by window. scratch:
  /// scratch_bytes bytes, aligned for any vector.
  using Score = void (*)(const Tables& tables, const Frame& frame, std::span<const Window> windows,
                         std::span<double> values, std::byte* scratch);
  /// The coefficients of one window as Plan::spectrum gives them.
  using Spectrum = void (*)(const Tables& tables, const Frame& frame, const Window& window,
                            std::span<std::complex<double>> coefficients, std::byte* scratch);

  Score score = nullptr;
  Spectrum spectrum = nullptr;
  std::size_t scratch_bytes = 0;
};

/// The kernel that a class implements: `moments` and `rings` are its measures, and `entropies` if it
/// has that.
template <class Implementation>
Kernel kernel_of(Measure measure) {
  Kernel kernel{nullptr, &Implementation::spectrum, Implementation::kScratchBytes};
  switch (measure) {
    case Measure::moment:
      kernel.score = &Implementation::moments;
      break;
    case Measure::rings:
      kernel.score = &Implementation::rings;
      break;
    case Measure::entropy:
      if constexpr (requires { &Implementation::entropies; })
        kernel.score = &Implementation::entropies;
      break;
  }
  return kernel;
}

/// f(N) with the side of the window as a constant.
template <class F>
Kernel with_size(int n, const F& f) {
  switch (n) {
    case 8:
      return f(std::integral_constant<int, 8>());
    case 16:
      return f(std::integral_constant<int, 16>());
    case 32:
      return f(std::integral_constant<int, 32>());
    case 64:
      return f(std::integral_constant<int, 64>());
    case 128:
      return f(std::integral_constant<int, 128>());
    case 256:
      return f(std::integral_constant<int, 256>());
    case 512:
      return f(std::integral_constant<int, 512>());
  }
  return {};  // no such side: is_window_side() stands before every plan
}

/// The kernels as compiled for one instruction set.
struct InstructionSet {
  const char* name;     ///< "AVX-512", "AVX2", "SSE4" or "NEON".
  const char* details;  ///< The width of its registers.
  Kernel (*fourier)(const MetricSpec& spec, Depth depth);
  Kernel (*walsh)(const MetricSpec& spec, Depth depth);
  Kernel (*integer_walsh)(const MetricSpec& spec);  ///< 8 bits, neither taper nor `power`.
  Kernel (*cosine)(const MetricSpec& spec, Depth depth);

  /// The one for a metric, for frames of one depth; empty for a transform that has none.
  Kernel kernel(const MetricSpec& spec, Depth depth) const;
};

/// Those that this processor runs, best first; none on one older than SSE4.
std::vector<InstructionSet> instruction_sets();

}  // namespace fathom::cpu
