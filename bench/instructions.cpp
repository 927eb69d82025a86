// SPDX-License-Identifier: Apache-2.0
// fathom_instructions METRIC DEVICE WINDOWS: scores that many windows on one thread, for a profiler
// to count. bench/instructions takes the difference of two runs, so that start-up cancels.
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <span>
#include <string>
#include <vector>

#include "backends/backends.hpp"
#include "bench/scene.hpp"
#include "engine/selection.hpp"

namespace fathom::bench {
namespace {

constexpr std::size_t kBatch = 64;  // the same in every run, so that plans are

void score(const MetricSpec& spec, const std::string& device, std::size_t count) {
  const auto selection = select_device(all_backends(), device, spec, kBatch, {.threads = 1});
  const auto plan = selection.device->plan(spec, kBatch);
  const Frame frame = random_frame();
  const auto windows = scattered_windows(spec.n, kBatch);
  std::vector<double> values(kBatch * spec.outputs());
  for (std::size_t done = 0; done < count; done += kBatch) {
    const std::size_t now = std::min(kBatch, count - done);
    plan->score(frame, std::span(windows).first(now),
                std::span(values).first(now * spec.outputs()));
  }
  fmt::print("{}\n", selection.device->info().name);
}

}  // namespace
}  // namespace fathom::bench

int main(int argc, char** argv) try {
  if (argc != 4) {
    fmt::print(stderr, "usage: fathom_instructions METRIC DEVICE WINDOWS\n");
    return 2;
  }
  fathom::bench::score(fathom::MetricSpec::parse(argv[1]), argv[2], std::stoul(argv[3]));
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "fathom_instructions: {}\n", error.what());
  return 1;
}
