// SPDX-License-Identifier: Apache-2.0
// The devices of the cpu backend, one for each instruction set, and work for them.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "backends/backends.hpp"
#include "tests/support/frames.hpp"

namespace fathom::test {

inline const Backend& backend_called(const std::string& name) {
  for (const Backend* backend : all_backends()) {
    if (backend->name() == name) return *backend;
  }
  throw std::runtime_error("this build has no backend called " + name);
}

inline const Backend& cpu() { return backend_called("cpu"); }

inline std::unique_ptr<Device> open_cpu(std::size_t index, int threads) {
  return cpu().open(index, {threads});
}

/// `count` windows all over a frame, no two neighbours at the same alignment.
inline std::vector<Window> scattered_windows(const Frame& frame, int n, std::size_t count) {
  SplitMix64 noise(count);
  std::vector<Window> windows;
  while (windows.size() < count) {
    const int x = static_cast<int>(noise.below(frame.width_px() - n + 1));
    windows.push_back({x, static_cast<int>(noise.below(frame.height_px() - n + 1)), n});
  }
  return windows;
}

/// A third flat, a third a ramp, a third noise: of windows all over it the Fourier kernels trust
/// float with some, and score those again in double whose spectra are nearly empty.
inline Frame half_smooth_frame(int bits, int width, int height, std::uint64_t seed) {
  Pixels pixels = make_pixels("random", bits, width, height, seed);
  const Pixels flat = make_pixels("flat", bits, width, height, seed);
  const Pixels ramp = make_pixels("ramp", bits, width, height, seed);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width * 2 / 3; ++x) {
      pixels.at(x, y) = (x < width / 3 ? flat : ramp).at(x, y);
    }
  }
  return to_frame(pixels);
}

/// One batch and what it scores on one thread of a device.
struct Batch {
  /// content: one of contents(), or "half smooth".
  Batch(const std::string& metric, int bits, std::size_t count, std::uint64_t seed = 5,
        const std::string& content = "random")
      : spec(MetricSpec::parse(metric)),
        frame(drawn(content, bits, 2 * spec.n + 101, 2 * spec.n + 37, seed)),
        windows(scattered_windows(frame, spec.n, count)) {}

  std::vector<double> scores_on(Device& device) const {
    std::vector<double> scores(windows.size() * spec.outputs());
    device.plan(spec, windows.size())->score(frame, windows, scores);
    return scores;
  }

  MetricSpec spec;
  Frame frame;
  std::vector<Window> windows;

 private:
  static Frame drawn(const std::string& content, int bits, int width, int height,
                     std::uint64_t seed) {
    return content == "half smooth" ? half_smooth_frame(bits, width, height, seed)
                                    : make_frame(content, bits, width, height, seed);
  }
};

/// A fixture that runs on every device of the cpu backend.
class EveryCpuDevice : public ::testing::TestWithParam<std::size_t> {
 protected:
  static std::unique_ptr<Device> open(int threads) { return open_cpu(GetParam(), threads); }
};

#define FATHOM_EVERY_CPU_DEVICE(fixture)                                                         \
  GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(fixture);                                        \
  INSTANTIATE_TEST_SUITE_P(                                                                      \
      Device, fixture, ::testing::Range(std::size_t{0}, ::fathom::test::cpu().devices().size()), \
      [](const auto& tested) { return "cpu_" + std::to_string(tested.param); })

}  // namespace fathom::test
