// SPDX-License-Identifier: Apache-2.0
// Devices of other kinds than the one that is there: smaller ones, and ones with a queue for
// copies.
#include "backends/backends.hpp"
#include "engine/selection.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/oracle_compare.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/vulkan/layered.hpp"

namespace fathom {
namespace {

using test::bit_equal;
using test::Counted;

class Devices : public test::Layered {
 protected:
  static std::vector<double> scores_of(Device& device, const char* spec, const Frame& frame,
                                       const std::vector<Window>& windows) {
    std::vector<double> scores(windows.size());
    const auto plan = device.plan(MetricSpec::parse(spec), windows.size());
    plan->score(frame, windows, scores);
    plan->score(frame, windows, scores);  // with the other flight
    return scores;
  }

  static std::vector<double> expected(const char* spec, const Frame& frame,
                                      const std::vector<Window>& windows) {
    return scores_of(*select_device(all_backends(), "cpu", MetricSpec::parse(spec), 1).device, spec,
                     frame, windows);
  }

  static void expect_scores(Device& device, const char* spec, const Frame& frame,
                            const std::vector<Window>& windows) {
    const auto got = scores_of(device, spec, frame, windows);
    const auto right = expected(spec, frame, windows);
    const MetricSpec metric = MetricSpec::parse(spec);
    for (std::size_t i = 0; i < windows.size(); ++i) {
      ASSERT_TRUE(test::score_matches(got[i], right[i], metric, test::score_tolerance(metric)))
          << spec << " window " << i;
    }
  }
};

TEST_F(Devices, CopiesTakeTheirOwnQueueWhereThereIsOne) {
  const Frame frame = test::make_frame("natural", 8, 300, 200, 3);
  const auto windows = window_grid(300, 200, {0, 0, 16}, 9);
  expect_scores(*open(), "walsh-sequency:16", frame, windows);
  EXPECT_EQ(layer().copies, 0);
  layer().has_transfer_queue = layer().pretends_to_be_gpu = true;
  expect_scores(*open(), "walsh-sequency:16", frame, windows);
  EXPECT_EQ(layer().copies, 2);
  EXPECT_EQ(layer().created_of(Counted::Semaphore), 2);
}

// Frames of several times the largest buffer, windows in an order that jumps all over them.
TEST_F(Devices, FramesOverTheBufferLimitAreCut) {
  const Frame frame = test::make_frame("natural", 16, 1100, 900, 3);
  auto windows = window_grid(1100, 900, {1, 2, 16}, 41);
  test::SplitMix64 noise(7);
  for (std::size_t i = windows.size() - 1; i > 0; --i) {
    std::swap(windows[i], windows[noise.below(static_cast<std::uint32_t>(i + 1))]);
  }
  layer().buffer_bytes = 262144;
  expect_scores(*open(), "walsh-sequency:16", frame, windows);
  expect_scores(*open(), "fft:16:hann", frame, windows);
}

TEST_F(Devices, ASmallDeviceScoresAllTheSame) {
  layer().is_small = true;
  const Frame frame = test::make_frame("natural", 8, 400, 300, 3);
  for (const char* spec : {"fft:8:none", "fft:64:hann", "walsh-paley:64", "fft:128:hann",
                           "walsh-sequency:128", "walsh-hadamard:256"}) {
    const int n = MetricSpec::parse(spec).n;
    expect_scores(*open(), spec, frame, window_grid(400, 300, {0, 0, n}, n == 8 ? 5 : 60));
  }
}

TEST_F(Devices, ADeviceThatIsTooSmallDeclinesAndSaysWhy) {
  layer().buffer_bytes = 1 << 20;
  const auto device = open();
  EXPECT_EQ(device->unsupported(MetricSpec::parse("fft:64:hann")), "");
  const std::string reason = device->unsupported(MetricSpec::parse("fft:512:hann"));
  EXPECT_NE(reason.find("1048576 bytes a buffer"), std::string::npos) << reason;
}

TEST_F(Devices, AutoTimesAGpuAgainstTheCpu) {
  const test::TemporaryFolder cache;
  const char* const old = std::getenv("XDG_CACHE_HOME");
  const std::string kept = old != nullptr ? old : "";
  setenv("XDG_CACHE_HOME", cache.path().c_str(), 1);
  layer().pretends_to_be_gpu = true;
  const Backend* const both[] = {&vulkan(), all_backends().back()};
  // Even a software device beats direct sums, and many threads' SIMD beats a software device.
  const auto spec = MetricSpec::parse("fft:64");
  EXPECT_EQ(select_device(both, "auto", spec, 4096).backend, "vulkan");
  const auto usual = select_device(all_backends(), "auto", spec, 16);
  EXPECT_EQ(usual.backend, "cpu");
  EXPECT_NE(usual.reason.find("vulkan:0"), std::string::npos) << usual.reason;
  kept.empty() ? unsetenv("XDG_CACHE_HOME") : setenv("XDG_CACHE_HOME", kept.c_str(), 1);
}

}  // namespace
}  // namespace fathom
