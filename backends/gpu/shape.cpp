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

/// A window's lines that are on chip at once, so many threads for each.
struct Team {
  int lines = 0, split = 0;
  bool is_padded = false;
  int threads() const { return lines * split; }
};

/// Numbers of a pool with which a team sums rings (kernels/rings.glsl): one for every ring and
/// thread, and what each kernel has beside them.
int summed_words(const MetricSpec& spec, int threads) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      return 0;
    case Measure::rings:
      break;
  }
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return 2 * (spec.n + 1) + (spec.rings + 3) * threads;
    case TransformFamily::walsh:
      return (spec.rings + 1) * threads + 3 * spec.rings;
    case TransformFamily::cosine:
      break;  // kernels/exact has slots of its own
  }
  return 0;
}

/// What a team exchanges at once: N rows of the lines on chip, and one number between them.
int exchange_bytes(int n, const Team& team) {
  return n * (team.lines + (team.is_padded ? 1 : 0)) * kNumberBytes;
}

int pool_bytes(const MetricSpec& spec, const Team& team) {
  return std::max(exchange_bytes(spec.n, team), summed_words(spec, team.threads()) * kNumberBytes);
}

/// Whether a team fits in a workgroup; and, where lines are few, two rows and their first numbers
/// again in what it exchanges (fft, mirror_rows_moment).
bool fits(const MetricSpec& spec, const Team& team, const Limits& limits) {
  if (exchange_bytes(spec.n, team) < 2 * (spec.n + 1) * kNumberBytes) return false;
  return static_cast<std::uint32_t>(team.threads()) <= limits.threads &&
         static_cast<std::uint32_t>(pool_bytes(spec, team)) <= limits.shared_bytes;
}

/// Kernels have butterflies for no more points of a line than this.
constexpr int kMostPoints = 64;

/// Points of a line that a thread keeps in registers, two numbers each: all of them where that is
/// not too many, because then the exchange between rows and columns is the only one. Threads that
/// share a line are fewer than their points, and want at least as many lines on chip.
int points_of(const MetricSpec& spec, const Limits& limits) {
  const int n = spec.n;
  int points = std::min(n, n <= 64 ? limits.points : n == 128 ? 16 : 32);
  const auto is_possible = [&] {
    const int split = n / points;
    return points > split && fits(spec, {split, split}, limits);
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

/// Numbers of two words that a thread which takes a window alone keeps for its rings.
std::uint64_t ring_bytes(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      return 0;
    case Measure::rings:
      return std::uint64_t{2} * kNumberBytes * (spec.rings + 3);
  }
  return 0;
}

/// One thread takes a window in vectors, tile by tile; a cache is its on-chip memory.
std::optional<Shape> vector_shape(Shape shape, const MetricSpec& spec, const Limits& limits) {
  const int n = spec.n;
  shape.points = n;
  shape.lanes = shape.lines = std::min(limits.lanes, n / 2);
  shape.threads = 1;
  const std::uint64_t scratch = scratch_bytes_of(n, shape.lanes);
  const int exchange = exchange_bytes(n, {shape.lines, 1});
  const std::uint64_t on_chip = exchange + ring_bytes(spec);
  if (scratch + on_chip > limits.shared_bytes) shape.scratch_bytes = scratch;
  const bool is_possible = exchange >= 2 * (n + 1) * kNumberBytes &&
                           on_chip <= limits.shared_bytes &&
                           shape.scratch_bytes <= limits.buffer_bytes;
  return is_possible ? std::optional(shape) : std::nullopt;
}

/// Where kernels/exact sums: the rings, and what lies in none.
std::uint64_t exact_slots(const MetricSpec& spec) {
  switch (spec.measure) {
    case Measure::moment:
    case Measure::entropy:
      return 0;
    case Measure::rings:
      return spec.rings + 1;
  }
  return 0;
}

Kernel kernel_for(const MetricSpec& spec, Depth depth) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return Kernel::fft;
    case TransformFamily::walsh:
      break;
    case TransformFamily::cosine:
      return Kernel::exact;
  }
  return depth == Depth::bits8 && spec.n <= 256 ? Kernel::walsh_float : Kernel::walsh_integer;
}

}  // namespace

bool needs_exact(const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      // A ring's error is judged by itself, and so may be float.
      return spec.measure == Measure::moment && spec.band.has_value();
    case TransformFamily::walsh:
      return spec.taper != Taper::none();
    case TransformFamily::cosine:
      return true;
  }
  return true;
}

bool may_need_exact(const MetricSpec& spec) {
  switch (family_of(spec.transform)) {
    case TransformFamily::fourier:
      return true;
    case TransformFamily::walsh:
    case TransformFamily::cosine:
      return needs_exact(spec);
  }
  return true;
}

std::optional<Shape> fast_shape(const MetricSpec& spec, Depth depth, const Limits& limits) {
  const int n = spec.n;
  Shape shape;
  shape.kernel = kernel_for(spec, depth);
  if (shape.kernel == Kernel::exact) return std::nullopt;
  shape.planes =
      shape.kernel == Kernel::walsh_integer && depth == Depth::bits16 && n == 512 ? 2 : 1;
  if (limits.lanes > 1) return vector_shape(shape, spec, limits);
  shape.points = points_of(spec, limits);
  if (shape.points > kMostPoints) return std::nullopt;
  const int split = n / shape.points;
  // As many lines as a workgroup holds: all of them, if it can be. Planes are told apart on their
  // way through scratch memory.
  Team team = {.lines = shape.planes > 1 ? n / 4 : n / 2, .split = split};
  while (team.lines > split && !fits(spec, team, limits)) team.lines /= 2;
  if (!fits(spec, team, limits)) return std::nullopt;
  team.is_padded = true;
  team.is_padded = fits(spec, team, limits);
  shape.lines = team.lines;
  shape.is_padded = team.is_padded;
  if (shape.lines < n / 2) {
    shape.scratch_bytes = scratch_bytes_of(n, 1);
    if (shape.scratch_bytes > limits.buffer_bytes) return std::nullopt;
  } else {
    shape.teams = teams_of(pool_bytes(spec, team), team.threads(), limits);
  }
  shape.threads = shape.teams * team.threads();
  return shape;
}

std::optional<Shape> exact_shape(const MetricSpec& spec, const Limits& limits) {
  Shape shape;
  shape.kernel = Kernel::exact;
  const std::uint32_t most = limits.lanes > 1 ? 1 : std::min(limits.threads, kExactThreads);
  shape.threads = static_cast<int>(std::bit_floor(most));
  shape.scratch_bytes = std::uint64_t{4} * kNumberBytes * spec.n * spec.n;
  // One sum of two numbers for each thread, and one for each of its slots.
  const std::uint64_t shared_bytes = std::uint64_t{2} * kNumberBytes * (1 + exact_slots(spec));
  while (shape.threads > 1 && shared_bytes * shape.threads > limits.shared_bytes) {
    shape.threads /= 2;
  }
  if (shape.scratch_bytes > limits.buffer_bytes ||
      shared_bytes * shape.threads > limits.shared_bytes) {
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

std::string no_kernel_for(Transform transform) {
  switch (transform) {
    case Transform::fft:
    case Transform::walsh_paley:
    case Transform::walsh_sequency:
    case Transform::walsh_hadamard:
    case Transform::dct:
      return {};
  }
  return fmt::format("there is no GPU kernel for {}", to_string(transform));
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
