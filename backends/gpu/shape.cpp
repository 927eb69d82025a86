// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "kernels/args.h"

namespace fathom::gpu {
namespace {

constexpr int kNumberBytes = 4;  // what threads exchange: floats or 32-bit integers

/// Threads of a workgroup that keep a GPU's lanes busy, and no team can be larger than the rest.
constexpr std::uint32_t kFewThreads = 32, kExactThreads = 128;

/// Scratch memory that keeps a large GPU busy with windows of 512, if it is no more than an eighth
/// of what it has.
constexpr std::uint64_t kScratchBytes = 256U << 20;

/// So that one that is late does not keep the other processors waiting.
constexpr std::uint32_t kGroupsPerProcessor = 4;

/// What a team exchanges at once: N rows of the lines on chip, and one number between them.
int pool_bytes(int n, int lines, bool is_padded) {
  return n * (lines + (is_padded ? 1 : 0)) * kNumberBytes;
}

/// Whether so many lines of a window, `split` threads each, fit in a workgroup; and, where lines
/// are few, two rows and their first numbers again in what they exchange (fft, mirror_rows_moment).
bool fits(int n, int lines, int split, const Limits& limits, bool is_padded = false) {
  if (pool_bytes(n, lines, is_padded) < 2 * (n + 1) * kNumberBytes) return false;
  return static_cast<std::uint32_t>(lines * split) <= limits.threads &&
         static_cast<std::uint32_t>(pool_bytes(n, lines, is_padded)) <= limits.shared_bytes;
}

/// Kernels have butterflies for no more points of a line than this.
constexpr int kMostPoints = 64;

/// Points of a line that a thread keeps in registers, two numbers each: all of them where that is
/// not too many, because then the exchange between rows and columns is the only one. Threads that
/// share a line are fewer than their points, and want at least as many lines on chip.
int points_of(int n, const Limits& limits) {
  int points = std::min(n, n <= 64 ? limits.points : n == 128 ? 16 : 32);
  const auto is_possible = [&] {
    const int split = n / points;
    return points > split && fits(n, split, split, limits);
  };
  while (points < n && !is_possible()) points *= 2;
  return points;
}

/// Windows that share a workgroup: side by side until a subgroup is full.
int teams_of(int pool, int team_threads, const Limits& limits) {
  const int wanted = static_cast<int>(std::max(limits.subgroup, kFewThreads)) / team_threads;
  const int by_memory = static_cast<int>(limits.shared_bytes) / pool;
  const int by_threads = static_cast<int>(limits.threads) / team_threads;
  const int teams = std::clamp(wanted, 1, std::min(by_memory, by_threads));
  return static_cast<int>(std::bit_floor(static_cast<unsigned>(teams)));
}

/// Bytes that the lines of a window take between columns and rows: padded, and one row twice
/// (kernels/window.clh).
std::uint64_t scratch_bytes_of(int n, int lanes) {
  return std::uint64_t{2} * kNumberBytes * (n / 2) * (n + lanes);
}

/// One thread takes a window in vectors, tile by tile; a cache is its on-chip memory.
std::optional<Shape> vector_shape(Shape shape, int n, const Limits& limits) {
  shape.points = n;
  shape.lanes = shape.lines = std::min(limits.lanes, n / 2);
  shape.threads = 1;
  const std::uint64_t scratch = scratch_bytes_of(n, shape.lanes);
  const int pool = pool_bytes(n, shape.lines, false);
  if (scratch + pool > limits.shared_bytes) shape.scratch_bytes = scratch;
  const bool is_possible = pool >= 2 * (n + 1) * kNumberBytes &&
                           static_cast<std::uint32_t>(pool) <= limits.shared_bytes &&
                           shape.scratch_bytes <= limits.buffer_bytes;
  return is_possible ? std::optional(shape) : std::nullopt;
}

Kernel kernel_for(const MetricSpec& spec, Depth depth) {
  if (!is_walsh(spec.transform)) return Kernel::fft;
  return depth == Depth::bits8 && spec.n <= 256 ? Kernel::walsh_float : Kernel::walsh_integer;
}

}  // namespace

bool needs_exact(const MetricSpec& spec) {
  return is_walsh(spec.transform) ? spec.taper != Taper::none() : spec.band.has_value();
}

std::optional<Shape> fast_shape(const MetricSpec& spec, Depth depth, const Limits& limits) {
  const int n = spec.n;
  Shape shape;
  shape.kernel = kernel_for(spec, depth);
  shape.planes =
      shape.kernel == Kernel::walsh_integer && depth == Depth::bits16 && n == 512 ? 2 : 1;
  if (limits.lanes > 1) return vector_shape(shape, n, limits);
  shape.points = points_of(n, limits);
  if (shape.points > kMostPoints) return std::nullopt;
  const int split = n / shape.points;
  // As many lines as a workgroup holds: all of them, if it can be. Planes are told apart on their
  // way through scratch memory.
  shape.lines = shape.planes > 1 ? n / 4 : n / 2;
  while (shape.lines > split && !fits(n, shape.lines, split, limits)) shape.lines /= 2;
  if (!fits(n, shape.lines, split, limits)) return std::nullopt;
  shape.is_padded = fits(n, shape.lines, split, limits, true);
  if (shape.lines < n / 2) {
    shape.scratch_bytes = scratch_bytes_of(n, 1);
    if (shape.scratch_bytes > limits.buffer_bytes) return std::nullopt;
  } else {
    shape.teams =
        teams_of(pool_bytes(n, shape.lines, shape.is_padded), shape.lines * split, limits);
  }
  shape.threads = shape.teams * shape.lines * split;
  return shape;
}

std::optional<Shape> exact_shape(const MetricSpec& spec, const Limits& limits) {
  Shape shape;
  shape.kernel = Kernel::exact;
  const std::uint32_t most = limits.lanes > 1 ? 1 : std::min(limits.threads, kExactThreads);
  shape.threads = static_cast<int>(std::bit_floor(most));
  shape.scratch_bytes = std::uint64_t{4} * kNumberBytes * spec.n * spec.n;
  const auto shared_bytes = static_cast<std::uint32_t>(2 * kNumberBytes * shape.threads);
  if (shape.scratch_bytes > limits.buffer_bytes || shared_bytes > limits.shared_bytes) {
    return std::nullopt;
  }
  return shape;
}

std::uint32_t workgroups_of(const Shape& shape, const Limits& limits, std::size_t windows) {
  std::uint64_t most =
      std::min<std::uint64_t>(limits.workgroups, std::max<std::size_t>(windows, 1));
  if (shape.scratch_bytes == 0) return static_cast<std::uint32_t>(most);
  if (limits.lanes > 1)
    most = std::min<std::uint64_t>(most, std::uint64_t{kGroupsPerProcessor} * limits.processors);
  const std::uint64_t room =
      std::min({kScratchBytes, limits.device_bytes / 8, limits.buffer_bytes});
  most = std::min(most, std::max<std::uint64_t>(room / shape.scratch_bytes, 1));
  return static_cast<std::uint32_t>(most);
}

std::string too_small_for(const MetricSpec& spec, const Limits& limits) {
  if (limits.storage_buffers < FATHOM_BINDINGS) {
    return fmt::format("it lets a kernel use {} buffers, and {} are needed", limits.storage_buffers,
                       FATHOM_BINDINGS);
  }
  const bool is_possible = (needs_exact(spec) || (fast_shape(spec, Depth::bits8, limits) &&
                                                  fast_shape(spec, Depth::bits16, limits))) &&
                           exact_shape(spec, limits);
  if (is_possible) return {};
  return fmt::format(
      "windows of {0} x {0} do not fit its limits of {1} bytes of shared memory, {2} "
      "threads and {3} bytes a buffer",
      spec.n, limits.shared_bytes, limits.threads, limits.buffer_bytes);
}

}  // namespace fathom::gpu
