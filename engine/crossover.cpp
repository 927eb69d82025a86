// SPDX-License-Identifier: Apache-2.0
#include "engine/crossover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <random>
#include <string>
#include <vector>

#include "engine/cache.hpp"

namespace fathom {
namespace {

constexpr std::size_t kMostTried = 4096;
constexpr int kRounds = 5;
constexpr double kBudget_s = 0.7;

/// Noise, because flat pictures could take a kernel another way.
Frame random_frame(int n) {
  const int width = std::max(512, 2 * n), height = std::max(384, 2 * n);
  std::minstd_rand random(1989);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
  for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(random() >> 8);
  return Frame(width, height, std::move(pixels));
}

std::vector<Window> scattered_windows(const Frame& frame, int n) {
  std::vector<Window> windows;
  for (std::size_t i = 0; i < kMostTried; ++i) {
    const auto k = static_cast<int>(i);
    windows.push_back(
        {k * 37 % (frame.width_px() - n + 1), k * 23 % (frame.height_px() - n + 1), n});
  }
  return windows;
}

/// Calls of one device, with the same windows each.
struct Calls {
  std::vector<double> wall_s;
  double processor_s = 0;  ///< Of the fastest.

  double fastest_s() const { return *std::min_element(wall_s.begin(), wall_s.end()); }
  double median_s() const {
    auto sorted = wall_s;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// Devices that score the same windows in turns: what disturbs one of them disturbs the others.
class Race {
 public:
  Race(std::span<Device* const> devices, const MetricSpec& spec, const Clock& clock)
      : clock_(clock),
        frame_(random_frame(spec.n)),
        windows_(scattered_windows(frame_, spec.n)),
        outputs_(spec.outputs()),
        values_(windows_.size() * outputs_) {
    for (Device* device : devices) plans_.push_back(device->plan(spec, kMostTried));
    for (const auto& plan : plans_) call(*plan, kFewestForGpu);  // buffers and caches
  }

  std::vector<Calls> run(std::size_t windows) {
    std::vector<Calls> calls(plans_.size());
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t i = 0; i < plans_.size(); ++i) time(*plans_[i], windows, calls[i]);
    }
    return calls;
  }

 private:
  void call(Plan& plan, std::size_t windows) {
    plan.score(frame_, std::span(windows_).first(windows),
               std::span(values_).first(windows * outputs_));
  }

  void time(Plan& plan, std::size_t windows, Calls& calls) {
    const double start = clock_.wall_s(), used = clock_.processor_s();
    call(plan, windows);
    const double processor_s = clock_.processor_s() - used;
    calls.wall_s.push_back(clock_.wall_s() - start);
    if (calls.wall_s.back() == calls.fastest_s()) calls.processor_s = processor_s;
  }

  const Clock& clock_;
  Frame frame_;
  std::vector<Window> windows_;
  std::size_t outputs_;
  std::vector<double> values_;
  std::vector<std::unique_ptr<Plan>> plans_;
};

/// Whether half of the calls contradict the fastest ones, and not by a little.
bool contradict(const Calls& winner, const Calls& loser) {
  constexpr double kClearly = 1.5;
  return winner.median_s() > kClearly * loser.median_s();
}

/// A processor that scores is busy all the time, unless others take it away.
bool was_interrupted(const Calls& cpu) {
  constexpr double kBusy = 0.75;
  return cpu.processor_s < kBusy * cpu.fastest_s();
}

/// Of what the answer depends on besides the metric.
std::string key_of(const Listed& gpu) {
  return fmt::format("{} {}\n{}\n{}\n{}\n", gpu.backend->name(), gpu.index, gpu.info.name,
                     gpu.info.details, gpu.backend->drivers());
}

Findings findings_of(std::string_view about, const std::string& key, const Clock& clock) {
  return {fmt::format("{}-{:016x}", about, hash_of(key)), key, clock};
}

/// Batches double, so that a step is within what two measurements may differ by.
bool within_a_step(std::size_t a, std::size_t b) {
  if (a == kNever || b == kNever) return a == b;
  return a <= 2 * b && b <= 2 * a;
}

std::string rivals_key(std::span<const Listed> gpus) {
  std::string key = "fastest 1\n";
  for (const Listed& gpu : gpus) key += key_of(gpu);
  return key;
}

}  // namespace

Measured measure_crossover(Device& gpu, Device& cpu, const MetricSpec& spec, const Clock& clock) {
  Device* const both[] = {&gpu, &cpu};
  Race race(both, spec, clock);
  const double start = clock.wall_s();
  double last_gap = 0;
  bool is_certain = true;
  for (std::size_t count = kFewestForGpu; count <= kMostTried; count *= 2) {
    const auto calls = race.run(count);
    const Calls &of_gpu = calls[0], &of_cpu = calls[1];
    const double gap = of_gpu.fastest_s() - of_cpu.fastest_s();
    if (gap < 0) {
      return {count, is_certain && !contradict(of_gpu, of_cpu) && !was_interrupted(of_cpu)};
    }
    is_certain = is_certain && !contradict(of_cpu, of_gpu);
    if (count > kFewestForGpu && clock.wall_s() - start > kBudget_s) {
      // Both times grow in proportion from here on, and so does what is between them.
      if (gap >= last_gap) return {kNever, is_certain};
      const double half = static_cast<double>(count) / 2;
      return {count + static_cast<std::size_t>(gap / (last_gap - gap) * half), is_certain};
    }
    last_gap = gap;
  }
  return {kNever, is_certain};
}

Measured measure_fastest(std::span<Device* const> devices, const MetricSpec& spec,
                         std::size_t windows, const Clock& clock) {
  const auto calls = Race(devices, spec, clock).run(std::clamp(windows, kFewestForGpu, kMostTried));
  const auto fastest = std::min_element(
      calls.begin(), calls.end(),
      [](const Calls& a, const Calls& b) { return a.fastest_s() < b.fastest_s(); });
  const bool is_certain = std::none_of(
      calls.begin(), calls.end(), [&](const Calls& other) { return contradict(*fastest, other); });
  return {static_cast<std::size_t>(fastest - calls.begin()), is_certain};
}

Findings crossovers_of(const Listed& gpu, const Device& cpu, const Clock& clock) {
  const std::string key = fmt::format("crossover 3\n{}{}\n{}\n{} threads\n", key_of(gpu),
                                      cpu.info().name, cpu.info().details, cpu.threads());
  return findings_of("crossover", key, clock);
}

std::size_t crossover(const Listed& listed, Device& gpu, Device& cpu, const MetricSpec& spec,
                      const Clock& clock) {
  Findings findings = crossovers_of(listed, cpu, clock);
  if (const auto known = findings.known(spec.text())) return *known;
  return findings.learn(spec.text(), measure_crossover(gpu, cpu, spec, clock), within_a_step);
}

Rivals::Rivals(std::span<const Listed> gpus, const MetricSpec& spec, std::size_t windows,
               const Clock& clock)
    : spec_(spec),
      windows_(std::min(std::bit_ceil(windows), kMostTried)),
      clock_(clock),
      findings_(findings_of("fastest", rivals_key(gpus), clock)),
      name_(fmt::format("{}@{}", spec.text(), windows_)) {}

std::size_t Rivals::measure(std::span<Device* const> devices) {
  return findings_.learn(name_, measure_fastest(devices, spec_, windows_, clock_),
                         std::equal_to<>());
}

}  // namespace fathom
