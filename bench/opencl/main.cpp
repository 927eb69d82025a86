// SPDX-License-Identifier: Apache-2.0
// fathom_opencl_bar: the opencl backend's whole score, from 8-bit pixels to one number, next to
// VkFFT's transform alone through the same OpenCL driver, in turns. Exits 1 if the bar is missed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <exception>

#include "backends/backends.hpp"
#include "bench/agreement.hpp"
#include "bench/opencl/batched_fft.hpp"
#include "bench/scene.hpp"
#include "engine/selection.hpp"

namespace fathom::bench {
namespace {

constexpr int kNoDevice = 77;  // what ctest takes for "skipped"
constexpr int kBarredSide = 64;
constexpr double kBar = 2;  // times as fast as VkFFT alone

struct Options {
  std::size_t device = 0;
  std::vector<int> sides = {8, 16, 32, 64, 128};
  std::size_t batch = 1024;
  int repetitions = 9;
  bool judges = true;
};

template <class Run>
double seconds_of(const Run& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

/// Microseconds a window.
struct Row {
  double real_us = 0, complex_us = 0, ours_us = 0;
  /// Of two real windows in a complex transform each costs half of it.
  double peer_us() const { return std::min(real_us, complex_us / 2); }
  double ratio() const { return peer_us() / ours_us; }
};

Row measure(Device& device, const opencl::PhysicalDevice& physical, int n, const Options& options) {
  const auto spec = MetricSpec::standard(Transform::fft, n);
  const auto plan = device.plan(spec, options.batch);
  const Scorer score = [&](const Frame& frame, std::span<const Window> windows,
                           std::span<double> scores) { plan->score(frame, windows, scores); };
  require_agreement("opencl", score, spec);
  const auto real = make_vkfft(physical, n, options.batch, true);
  const auto complex = make_vkfft(physical, n, options.batch, false);
  const Frame frame = random_frame();
  const auto windows = scattered_windows(n, options.batch);
  std::vector<double> scores(windows.size());
  std::vector<double> real_s, complex_s, ours_s;
  for (int i = 0; i <= options.repetitions; ++i) {
    const double first = seconds_of([&] { real->run(); });
    const double second = seconds_of([&] { complex->run(); });
    const double third = seconds_of([&] { plan->score(frame, windows, scores); });
    if (i == 0) continue;  // compiles
    real_s.push_back(first);
    complex_s.push_back(second);
    ours_s.push_back(third);
  }
  const double to_us = 1e6 / static_cast<double>(options.batch);
  return {median(real_s) * to_us, median(complex_s) * to_us, median(ours_s) * to_us};
}

int run(const Options& options) {
  const auto devices = opencl::list_devices();
  if (options.device >= devices.size()) {
    fmt::print(stderr, "fathom_opencl_bar: NOTHING IS TIMED: no device opencl:{}\n",
               options.device);
    return kNoDevice;
  }
  const auto chosen =
      select_device(all_backends(), fmt::format("opencl:{}", options.device),
                    MetricSpec::standard(Transform::fft, kBarredSide), options.batch);
  fmt::print("{}: {}\n{} windows a batch, us a window, medians of {}\n\n",
             chosen.device->info().name, chosen.device->info().details, options.batch,
             options.repetitions);
  fmt::print("{:>4} {:>12} {:>18} {:>12} {:>7}\n", "N", "VkFFT, real", "VkFFT, complex/2",
             "fathom, all", "times");
  bool holds = true;
  for (const int n : options.sides) {
    const Row row = measure(*chosen.device, devices[options.device], n, options);
    fmt::print("{:4} {:12.3f} {:18.3f} {:12.3f} {:7.2f}\n", n, row.real_us, row.complex_us / 2,
               row.ours_us, row.ratio());
    std::fflush(stdout);
    if (n == kBarredSide) holds = row.ratio() >= kBar;
  }
  if (!options.judges) return 0;
  fmt::print("\n{} fft:{}:hann: at least {} times as fast as VkFFT's transform alone\n",
             holds ? "ok    " : "MISSED", kBarredSide, kBar);
  return holds ? 0 : 1;
}

}  // namespace
}  // namespace fathom::bench

int main(int argc, char** argv) try {
  fathom::bench::Options options;
  CLI::App app{"The opencl backend's score next to VkFFT's transform alone, on the same device."};
  app.add_option("--device", options.device, "opencl:INDEX as `fathom devices` has it (0)");
  app.add_option("--sides", options.sides, "which N")
      ->delimiter(',')
      ->check(CLI::IsMember({8, 16, 32, 64, 128}));
  app.add_option("--batch", options.batch, "windows a call (1024)")->check(CLI::Range(2, 1 << 16));
  app.add_option("--repetitions", options.repetitions, "of every time (9)")
      ->check(CLI::Range(1, 1000));
  app.add_flag("!--no-bar", options.judges, "times only");
  CLI11_PARSE(app, argc, argv);
  return fathom::bench::run(options);
} catch (const std::exception& error) {
  fmt::print(stderr, "fathom_opencl_bar: {}\n", error.what());
  return 1;
}
