// SPDX-License-Identifier: Apache-2.0
// From how many windows a call on a GPU is worth its detour, and which of several GPUs is the
// fastest: measured, not guessed.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "backend.hpp"
#include "findings.hpp"

namespace fathom {

/// Below so many windows a call a GPU is not even looked for: reaching one takes some 10 us, in
/// which a processor scores several windows, and connecting to its driver tens of milliseconds.
inline constexpr std::size_t kFewestForGpu = 16;

/// The answer of a device that does not win at any batch that was tried.
inline constexpr std::size_t kNever = std::numeric_limits<std::size_t>::max();

/// The least of the batches tried (kFewestForGpu, doubling up to 4096) from which `gpu` scores a
/// call sooner than `cpu`, uploads and waiting included; kNever if none. Both take turns, and the
/// fastest of several calls counts. Takes up to a second. It is uncertain where the machine was
/// busy: the processor spent less time on the CPU's fastest call than the call took, or half of
/// the calls tell another story than the fastest ones.
/// Throws what making a plan throws.
Measured measure_crossover(Device& gpu, Device& cpu, const MetricSpec& spec, const Clock& clock);

/// Which of the devices, two at least, scores so many windows a call the soonest, by its place in
/// the list; they take turns. Throws what making a plan throws.
Measured measure_fastest(std::span<Device* const> devices, const MetricSpec& spec,
                         std::size_t windows, const Clock& clock);

/// A device before it is opened.
struct Listed {
  const Backend* backend = nullptr;
  std::size_t index = 0;
  DeviceInfo info;
};

/// What was learned of these devices, from the file cache (findings.hpp): crossovers by metric. The
/// key holds the drivers and the kernels.
Findings crossovers_of(const Listed& gpu, const Device& cpu, const Clock& clock);

/// What measure_crossover says, or once said: measured if that is due.
std::size_t crossover(const Listed& listed, Device& gpu, Device& cpu, const MetricSpec& spec,
                      const Clock& clock = machine_clock());

/// Which of several GPUs was the fastest, by metric and by windows a call.
class Rivals {
 public:
  Rivals(std::span<const Listed> gpus, const MetricSpec& spec, std::size_t windows,
         const Clock& clock);
  /// By its place in the list; nothing where a measurement is due.
  std::optional<std::size_t> known() const { return findings_.known(name_); }
  /// The devices are the opened gpus, in the same order. Throws as measure_fastest does.
  std::size_t measure(std::span<Device* const> devices);

 private:
  MetricSpec spec_;
  std::size_t windows_;
  const Clock& clock_;
  Findings findings_;
  std::string name_;
};

}  // namespace fathom
