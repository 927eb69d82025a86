// SPDX-License-Identifier: Apache-2.0
// From how many windows a call on a GPU is worth its detour: measured, not guessed.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>

#include "backend.hpp"

namespace fathom {

/// Below so many windows a call a GPU is not even looked for: reaching one takes some 10 us, in
/// which a processor scores several windows, and connecting to its driver tens of milliseconds.
inline constexpr std::size_t kFewestForGpu = 16;

/// The answer of a device that does not win at any batch that was tried.
inline constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

/// The least of the batches tried (kFewestForGpu, doubling up to 4096) from which `gpu` scores a
/// call sooner than `cpu`, uploads and waiting included; kNever if none. Takes up to a second.
/// Throws what making a plan throws.
std::size_t measure_crossover(Device& gpu, Device& cpu, const MetricSpec& spec);

/// What measure_crossover said once for these devices, from the file cache; measured and kept if
/// it is not there. backend: of the gpu, as a backend's name. Throws as measure_crossover.
std::size_t crossover(std::string_view backend, Device& gpu, Device& cpu, const MetricSpec& spec);

}  // namespace fathom
