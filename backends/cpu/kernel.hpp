// SPDX-License-Identifier: Apache-2.0
// What stands between the cpu backend and the code that is compiled once per instruction set.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "backends/cpu/tables.hpp"
#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::cpu {

/// Most windows that a kernel scores at once. Small windows lie side by side in the lanes of one
/// register, so that a full block costs little more than one window.
inline constexpr int kBlock = 16;

/// One kernel: a transform of one size on pixels of one depth.
struct Kernel {
  /// Scores at most kBlock windows. scratch: scratch_bytes bytes, aligned for any vector.
  using Score = void (*)(const Tables& tables, const Frame& frame, std::span<const Window> windows,
                         std::span<double> scores, std::byte* scratch);
  /// The coefficients of one window as Plan::spectrum gives them.
  using Spectrum = void (*)(const Tables& tables, const Frame& frame, const Window& window,
                            std::span<std::complex<double>> coefficients, std::byte* scratch);

  Score score = nullptr;
  Spectrum spectrum = nullptr;
  std::size_t scratch_bytes = 0;
};

/// The kernels as compiled for one instruction set.
struct InstructionSet {
  const char* name;     ///< "AVX-512", "AVX2", "SSE4" or "NEON".
  const char* details;  ///< The width of its registers.
  Kernel (*fourier)(const MetricSpec& spec, Depth depth);
  Kernel (*walsh)(const MetricSpec& spec, Depth depth);
  Kernel (*exact_walsh)(const MetricSpec& spec);  ///< 8 bits, neither taper nor `power`.

  /// The one for a metric, for frames of one depth; empty for a transform that has none.
  Kernel kernel(const MetricSpec& spec, Depth depth) const;
};

/// Those that this processor runs, best first; none on one older than SSE4.
std::vector<InstructionSet> instruction_sets();

}  // namespace fathom::cpu
