// SPDX-License-Identifier: Apache-2.0
// How a kernel is cut for a device: which threads do what, from the device's limits.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/frame.hpp"
#include "engine/metric.hpp"

namespace fathom::gpu {

/// What a device allows, as its driver says.
struct Limits {
  std::uint32_t shared_bytes = 16384;  ///< Memory that the threads of a workgroup share.
  std::uint32_t threads = 128;         ///< Of a workgroup.
  std::uint32_t workgroups = 65535;    ///< Of a dispatch.
  std::uint64_t buffer_bytes = 1U << 27;
  std::uint64_t device_bytes = 1U << 31;  ///< All of its memory.
  std::uint32_t storage_buffers = 8;      ///< That one kernel may use.
  std::uint32_t subgroup = 32;            ///< Threads that go in step.
  int points = 64;  ///< Most of a line that a thread should keep in registers.
  /// Numbers that one instruction of a processor takes; 1 for what has many threads instead.
  int lanes = 1;
  std::uint32_t processors = 1;  ///< That have lanes.
};

/// Which of the files in kernels/.
enum class Kernel { fft, walsh_float, walsh_integer, exact };
inline constexpr Kernel kAllKernels[] = {Kernel::fft, Kernel::walsh_float, Kernel::walsh_integer,
                                         Kernel::exact};

/// A kernel's specialisation constants that are not the metric's own (kernels/window.glsl, .clh),
/// and what follows from them.
struct Shape {
  Kernel kernel = Kernel::fft;
  int points = 0;                   ///< Of a line, kept by one thread.
  int lines = 0;                    ///< Of a window, on chip at once.
  int lanes = 1;                    ///< Of these, taken by one thread as a vector.
  int teams = 1;                    ///< Windows that share a workgroup.
  int planes = 1;                   ///< 32-bit planes of a coefficient.
  bool is_padded = false;           ///< Rows of a pool are apart, to miss each other's banks.
  int threads = 0;                  ///< Of a workgroup.
  std::uint64_t scratch_bytes = 0;  ///< Per workgroup; 0 where shared memory will do.
  bool operator==(const Shape&) const = default;
};

/// Whether a metric is computed by kernels/exact alone.
bool needs_exact(const MetricSpec& spec);

/// Whether windows may need kernels/exact, all or some of them.
bool may_need_exact(const MetricSpec& spec);

/// The fast kernel for a metric and a depth; nothing where the device is too small for it.
std::optional<Shape> fast_shape(const MetricSpec& spec, Depth depth, const Limits& limits);

/// kernels/exact.
std::optional<Shape> exact_shape(const MetricSpec& spec, const Limits& limits);

/// Workgroups of one dispatch, at most one per window: as many as the device allows and its memory
/// has scratch memory for; processors a few, which stay in their caches.
std::uint32_t workgroups_of(const Shape& shape, const Limits& limits, std::size_t windows);

/// Why there is no kernel for a transform; empty for those that there are kernels for.
std::string no_kernel_for(Transform transform);

/// Why a device of these limits cannot compute the metric; empty if it can, as every device that
/// Vulkan allows. OpenCL allows fewer threads.
std::string too_small_for(const MetricSpec& spec, const Limits& limits);

}  // namespace fathom::gpu
