// SPDX-License-Identifier: Apache-2.0
#include "engine/crossover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "engine/cache.hpp"

namespace fathom {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostTried = 4096;
constexpr int kRepetitions = 3;
constexpr std::chrono::milliseconds kBudget{700};

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

/// The fastest of some calls: both devices are disturbed now and then, and neither is for long.
Clock::duration time_of(Plan& plan, const Frame& frame, std::span<const Window> windows,
                        std::span<double> scores) {
  auto fastest = Clock::duration::max();
  for (int i = 0; i < kRepetitions; ++i) {
    const auto start = Clock::now();
    plan.score(frame, windows, scores);
    fastest = std::min(fastest, Clock::now() - start);
  }
  return fastest;
}

/// Of what the answer depends on besides the metric.
std::string key_of(std::string_view backend, const Device& gpu, const Device& cpu) {
  return fmt::format("crossover 2\n{}\n{}\n{}\n{}\n{}\n{} threads\n", backend, gpu.info().name,
                     gpu.info().details, cpu.info().name, cpu.info().details, cpu.threads());
}

/// "METRIC WINDOWS" a line.
std::optional<std::size_t> find(const std::string& lines, const std::string& metric) {
  std::istringstream stream(lines);
  std::string name;
  for (std::size_t windows; stream >> name >> windows;) {
    if (name == metric) return windows;
  }
  return std::nullopt;
}

}  // namespace

std::size_t measure_crossover(Device& gpu, Device& cpu, const MetricSpec& spec) {
  const auto gpu_plan = gpu.plan(spec, kMostTried), cpu_plan = cpu.plan(spec, kMostTried);
  const Frame frame = random_frame(spec.n);
  const auto windows = scattered_windows(frame, spec.n);
  std::vector<double> scores(windows.size() * spec.outputs());
  const auto batch = std::span(windows).first(kFewestForGpu);
  for (Plan* plan : {gpu_plan.get(), cpu_plan.get()}) {  // buffers and caches
    plan->score(frame, batch, std::span(scores).first(kFewestForGpu * spec.outputs()));
  }
  const auto start = Clock::now();
  double last_gap = 0;
  for (std::size_t count = kFewestForGpu; count <= kMostTried; count *= 2) {
    const auto some = std::span(windows).first(count);
    const auto room = std::span(scores).first(count * spec.outputs());
    const auto gpu_takes = time_of(*gpu_plan, frame, some, room);
    const auto cpu_takes = time_of(*cpu_plan, frame, some, room);
    if (gpu_takes < cpu_takes) return count;
    const double gap = std::chrono::duration<double>(gpu_takes - cpu_takes).count();
    if (count > kFewestForGpu && Clock::now() - start > kBudget) {
      // Both times grow in proportion from here on, and so does what is between them.
      if (gap >= last_gap) return kNever;
      const double half = static_cast<double>(count) / 2;
      return count + static_cast<std::size_t>(gap / (last_gap - gap) * half);
    }
    last_gap = gap;
  }
  return kNever;
}

std::size_t crossover(std::string_view backend, Device& gpu, Device& cpu, const MetricSpec& spec) {
  const std::string key = key_of(backend, gpu, cpu), metric = spec.text();
  const std::string file = fmt::format("crossover-{:016x}", hash_of(key));
  std::string lines = read_cached(file, key).value_or(std::string());
  if (const auto known = find(lines, metric)) return *known;
  const std::size_t measured = measure_crossover(gpu, cpu, spec);
  write_cached(file, key, lines + fmt::format("{} {}\n", metric, measured));
  return measured;
}

}  // namespace fathom
