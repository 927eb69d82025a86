// SPDX-License-Identifier: Apache-2.0
// Devices of other kinds than the one that is there: smaller ones, and ones with a queue for
// copies.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include "backends/backends.hpp"
#include "engine/file.hpp"
#include "engine/selection.hpp"
#include "tests/support/frames.hpp"
#include "tests/support/oracle_compare.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/gpu/layered.hpp"

namespace fathom {
namespace {

class Devices : public test::OnEveryGpuBackend {
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

FATHOM_ON_EVERY_GPU_BACKEND(Devices);

TEST_P(Devices, CopiesTakeTheirOwnQueueWhereThereIsOne) {
  const Frame frame = test::make_frame("natural", 8, 300, 200, 3);
  const auto windows = window_grid(300, 200, {0, 0, 16}, 9);
  expect_scores(*open(), "walsh-sequency:16", frame, windows);
  EXPECT_EQ(layer().copies, 0);
  layer().has_transfer_queue = layer().pretends_to_be_gpu = true;
  expect_scores(*open(), "walsh-sequency:16", frame, windows);
  EXPECT_EQ(layer().copies, 2);
}

// Frames of several times the largest buffer, windows in an order that jumps all over them.
TEST_P(Devices, FramesOverTheBufferLimitAreCut) {
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

TEST_P(Devices, ASmallDeviceScoresAllTheSame) {
  layer().is_small = true;
  const Frame frame = test::make_frame("natural", 8, 400, 300, 3);
  for (const char* spec : {"fft:8:none", "fft:64:hann", "walsh-paley:64", "fft:128:hann",
                           "walsh-sequency:128", "walsh-hadamard:256"}) {
    const int n = MetricSpec::parse(spec).n;
    expect_scores(*open(), spec, frame, window_grid(400, 300, {0, 0, n}, n == 8 ? 5 : 60));
  }
}

TEST_P(Devices, ADeviceThatIsTooSmallDeclinesAndSaysWhy) {
  layer().buffer_bytes = 1 << 20;
  const auto device = open();
  EXPECT_EQ(device->unsupported(MetricSpec::parse("fft:64:hann")), "");
  const std::string reason = device->unsupported(MetricSpec::parse("fft:512:hann"));
  EXPECT_NE(reason.find("1048576 bytes a buffer"), std::string::npos) << reason;
}

// Fewer threads, or less memory that they share, than any GPU has: right scores, or a reason.
TEST_P(Devices, ATinyDeviceScoresRightOrDeclines) {
  const Frame frame = test::make_frame("natural", 16, 530, 520, 3);
  layer().is_small = true;
  int declined = 0, scored = 0;
  for (const auto& [threads, shared] :
       {std::pair(1U, 0U), {12U, 0U}, {64U, 0U}, {0U, 1024U}, {0U, 2048U}}) {
    layer().threads = threads;
    layer().shared_bytes = shared;
    const auto device = open();
    for (const char* spec : {"fft:8:none", "walsh-paley:8", "fft:128:hann", "walsh-sequency:128"}) {
      SCOPED_TRACE(fmt::format("{} threads, {} bytes", threads, shared));
      const MetricSpec metric = MetricSpec::parse(spec);
      if (!device->unsupported(metric).empty()) {
        ++declined;
        continue;
      }
      ++scored;
      expect_scores(*device, spec, frame, {{0, 0, metric.n}, {400, 390, metric.n}});
    }
  }
  EXPECT_GT(declined, 0);
  EXPECT_GT(scored, 6);
}

/// A cache folder of the test's own.
class Caching : public Devices {
 protected:
  void SetUp() override {
    Devices::SetUp();
    const char* const old = std::getenv("FATHOM_CACHE");
    if (old != nullptr) old_ = old;
    // Ours alone: drivers keep files where they found a folder first, and this one will go.
    setenv("FATHOM_CACHE", (folder_ / "fathom").c_str(), 1);
  }
  void TearDown() override {
    old_ ? setenv("FATHOM_CACHE", old_->c_str(), 1) : unsetenv("FATHOM_CACHE");
    Devices::TearDown();
  }

  /// The one file of ours whose name ends so.
  std::filesystem::path kept(const std::string& ending) const {
    std::error_code missing;  // then the range is empty
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "fathom", missing)) {
      if (entry.path().string().ends_with(ending)) return entry.path();
    }
    return {};
  }

  /// What ends the name of a file of compiled kernels.
  std::string programs() const { return name() == "vulkan" ? ".pipelines" : ".program"; }

  test::TemporaryFolder folder_;

 private:
  std::optional<std::string> old_;
};

FATHOM_ON_EVERY_GPU_BACKEND(Caching);

TEST_P(Caching, KernelsAreKeptAndADamagedFileIsReplaced) {
  const MetricSpec spec = MetricSpec::parse("walsh-paley:8");
  const Frame frame = test::make_frame("random", 8, 8, 8, 1);
  // PoCL's programs hold what it has compiled when a kernel ran, where it has, in any process.
  expect_scores(*open(), "walsh-paley:8", frame, {{0, 0, 8}});
  std::filesystem::remove(kept(programs()));
  open()->plan(spec, 1);
  const auto file = kept(programs());
  ASSERT_FALSE(file.empty()) << "nothing is kept";
  const std::string whole = read_file(file);
  open()->plan(spec, 1);
  EXPECT_EQ(read_file(file), whole);
  for (const std::string& damaged :
       {whole.substr(0, whole.size() / 2), whole + "x", std::string(), std::string(100'000, 'x')}) {
    write_file(file, damaged);
    expect_scores(*open(), "walsh-paley:8", frame, {{0, 0, 8}});
    EXPECT_EQ(read_file(file), whole);
  }
}

TEST_P(Caching, ADriverThatRefusesItsOwnProgramsCompilesAgain) {
  const Frame frame = test::make_frame("random", 8, 8, 8, 1);
  expect_scores(*open(), "walsh-paley:8", frame, {{0, 0, 8}});
  layer().refuses_programs = true;
  expect_scores(*open(), "walsh-paley:8", frame, {{0, 0, 8}});
}

TEST_P(Caching, ADeviceThatComputesWrongDeclines) {
  const MetricSpec fft = MetricSpec::parse("fft:8"), walsh = MetricSpec::parse("walsh-paley:8");
  EXPECT_EQ(open()->unsupported(fft), "");
  std::filesystem::remove_all(folder_ / "fathom");
  layer().miscompiles = true;
  const auto device = open();
  const std::string reason = device->unsupported(fft);
  EXPECT_NE(reason.find("arithmetic is not exact enough"), std::string::npos) << reason;
  EXPECT_NE(device->unsupported(MetricSpec::parse("walsh-paley:8:hann")), "");
  EXPECT_EQ(device->unsupported(walsh), "");
  layer().miscompiles = false;
  // A mended driver has another version, and so no use for what the faulty one compiled.
  while (!kept(programs()).empty()) std::filesystem::remove(kept(programs()));
  EXPECT_EQ(open()->unsupported(fft), "") << "held against a driver that was mended";
}

TEST_P(Caching, AutoTimesAGpuAgainstTheCpu) {
  layer().pretends_to_be_gpu = true;
  const auto chosen = select_device(all_backends(), "auto", MetricSpec::parse("walsh-paley:8"), 64);
  // SIMD beats a software device at every batch, unless a sanitizer watches the one and not the
  // other.
  EXPECT_TRUE(chosen.backend == "cpu" || chosen.backend == name());
  EXPECT_NE(chosen.reason.find(name() + ":0"), std::string::npos) << chosen.reason;
  const bool was_timed = chosen.reason.find("slower than the CPU") != std::string::npos ||
                         chosen.reason.find("wins from") != std::string::npos;
  EXPECT_TRUE(was_timed) << chosen.reason;
}

}  // namespace
}  // namespace fathom
