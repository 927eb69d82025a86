// SPDX-License-Identifier: Apache-2.0
// The choice of a backend, with backends that exist only here.
#include "engine/selection.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/crossover.hpp"
#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/engine/fake_devices.hpp"

namespace fathom {
namespace {

using test::expect_error;

using test::FakeBackend;

constexpr std::size_t kMany = 100'000;

class Choosing : public ::testing::Test {
 protected:
  void SetUp() override {
    unsetenv("FATHOM_BACKEND");
    setenv("XDG_CACHE_HOME", cache_.path().c_str(), 1);
    vulkan.for_gpus = none.for_gpus = true;
  }
  void TearDown() override {
    unsetenv("FATHOM_BACKEND");
    unsetenv("XDG_CACHE_HOME");
  }

  Selection choose(std::string_view text, std::size_t windows = kMany,
                   const char* metric = "fft:64") const {
    const Backend* const table[] = {&vulkan, &cpu, &none, &reference};
    return select_device(table, text, MetricSpec::parse(metric), windows, options, world.clock);
  }
  /// "BACKEND/DEVICE" of what was chosen.
  std::string chosen(std::string_view text, std::size_t windows = kMany,
                     const char* metric = "fft:64") const {
    const Selection selection = choose(text, windows, metric);
    EXPECT_EQ(selection.reason.find('\n'), std::string::npos);
    return selection.backend + "/" + selection.device->info().name;
  }

  test::FakeWorld world;
  DeviceOptions options;
  FakeBackend vulkan{world,
                     "vulkan",
                     {{"llvmpipe", DeviceKind::software, ""},
                      {"GeForce One", DeviceKind::gpu, ""},
                      {"GeForce Two", DeviceKind::gpu, ""}},
                     {100, 0.05}};
  FakeBackend cpu{world, "cpu", {{"AVX2", DeviceKind::cpu, ""}}, {0, 1}};
  FakeBackend none{world, "opencl", {}, {}};
  FakeBackend reference{world, "reference", {{"direct sums", DeviceKind::cpu, ""}}, {0, 1}};

 private:
  test::TemporaryFolder cache_;
};

TEST_F(Choosing, AutoTakesAGpuForBatchesAndTheCpuForSingleWindows) {
  for (const char* text : {"auto", ""}) {
    EXPECT_EQ(chosen(text, kMany), "vulkan/GeForce One");
    EXPECT_EQ(chosen(text, 1), "cpu/AVX2");
  }
}

// 16 windows take this GPU 100 us and this CPU 16; 128 take it 106.
TEST_F(Choosing, AutoTakesTheCpuBelowTheMeasuredCrossover) {
  EXPECT_EQ(chosen("auto", kFewestForGpu), "cpu/AVX2");
  EXPECT_EQ(chosen("auto", 127), "cpu/AVX2");
  EXPECT_EQ(chosen("auto", 128), "vulkan/GeForce One");
  const std::string reason = choose("auto", kFewestForGpu).reason;
  EXPECT_NE(reason.find("vulkan:1 (GeForce One): wins from 128 windows a call on"),
            std::string::npos)
      << reason;
  vulkan.cost = {0, 2};
  vulkan.infos[1].name = vulkan.infos[2].name = "GeForce Slow";
  EXPECT_EQ(chosen("auto", kMany), "cpu/AVX2");
  EXPECT_NE(choose("auto").reason.find("slower than the CPU"), std::string::npos);
}

TEST_F(Choosing, AutoTakesTheFastestOfSeveralGpus) {
  vulkan.costs = {{}, {100, 0.05}, {150, 0.01}};  // the second one from 1250 windows on
  EXPECT_EQ(chosen("auto", 512), "vulkan/GeForce One");
  EXPECT_EQ(chosen("auto", 4096), "vulkan/GeForce Two");
  const std::string reason = choose("auto", 4096).reason;
  EXPECT_NE(reason.find("vulkan:1 (GeForce One): slower than the other GPU"), std::string::npos)
      << reason;
}

TEST_F(Choosing, AutoOpensNoGpuThatIsKnownToLose) {
  vulkan.costs = {{}, {100, 0.05}, {150, 0.01}};
  choose("auto", 4096);
  const int opened = vulkan.opened;
  EXPECT_EQ(chosen("auto", 4096), "vulkan/GeForce Two");
  EXPECT_EQ(vulkan.opened, opened + 1) << "the slower one too";
  EXPECT_EQ(chosen("auto", kFewestForGpu), "cpu/AVX2");
  EXPECT_EQ(vulkan.opened, opened + 1) << "though the CPU is known to win";
}

TEST_F(Choosing, AutoAsksDriversOfSoftwareOnlyOnce) {
  vulkan.infos.resize(1);
  vulkan.driver_files = "llvmpipe 22";
  for (int start = 0; start < 3; ++start) EXPECT_EQ(chosen("auto", kMany), "cpu/AVX2");
  EXPECT_EQ(vulkan.listed, 1);
  EXPECT_EQ(vulkan.opened, 0);
  EXPECT_NE(choose("auto").reason.find("vulkan:0 (llvmpipe): a software rasteriser"),
            std::string::npos);
  vulkan.driver_files = "llvmpipe 23, NVIDIA 550";
  vulkan.infos.push_back({"GeForce One", DeviceKind::gpu, ""});
  EXPECT_EQ(chosen("auto", kMany), "vulkan/GeForce One");
}

TEST_F(Choosing, AGpuThatIsGoneIsLookedForAgain) {
  vulkan.driver_files = "NVIDIA 550";
  EXPECT_EQ(chosen("auto", kMany), "vulkan/GeForce One");
  vulkan.infos = {{"llvmpipe", DeviceKind::software, ""}, {"Radeon", DeviceKind::gpu, ""}};
  EXPECT_EQ(chosen("auto", kMany), "cpu/AVX2") << "the list is not what it was";
  EXPECT_EQ(chosen("auto", kMany), "vulkan/Radeon");
}

TEST_F(Choosing, SaysWhatTakesLong) {
  std::string said;
  options.on_work = [&](Work work, const std::string& subject) {
    constexpr const char* kNames[] = {"listing", "opening", "timing", "done"};
    said += std::string(kNames[static_cast<int>(work)]) + " " + subject + "\n";
  };
  vulkan.infos.resize(2);
  choose("auto");
  EXPECT_EQ(said,
            "listing vulkan\nlisting opencl\nopening vulkan:1 (GeForce One)\n"
            "timing vulkan:1 (GeForce One)\ndone \n");
  said.clear();
  choose("auto", 1);
  EXPECT_EQ(said, "done \n");
  expect_error(ErrorCode::unavailable, [&] { choose("metal"); });
  EXPECT_EQ(said, "done \ndone \n") << "after an error too";
}

TEST_F(Choosing, AutoDoesNotTroubleGpusForFewWindows) {
  choose("auto", kFewestForGpu - 1);
  EXPECT_EQ(vulkan.listed, 0);
  choose("auto", kFewestForGpu);
  EXPECT_EQ(vulkan.listed, 1);
}

TEST_F(Choosing, AutoSurvivesAGpuWithoutMemory) {
  vulkan.cost.call_us = -1;
  const Selection selection = choose("auto");
  EXPECT_EQ(selection.backend, "cpu");
  EXPECT_NE(selection.reason.find("no memory left"), std::string::npos) << selection.reason;
}

TEST_F(Choosing, AutoFallsBackInOrder) {
  cpu.broken = true;
  EXPECT_EQ(chosen("auto", 1), "reference/direct sums");
  vulkan.broken = true;
  EXPECT_EQ(chosen("auto", kMany), "reference/direct sums");
  vulkan.broken = false;
  cpu.infos.clear();
  reference.infos.clear();
  EXPECT_EQ(chosen("auto", 1), "vulkan/GeForce One");
}

TEST_F(Choosing, AutoNeverTakesASoftwareRasteriser) {
  vulkan.infos.resize(1);
  EXPECT_EQ(chosen("auto", kMany), "cpu/AVX2");
  cpu.infos.clear();
  reference.infos.clear();
  expect_error(ErrorCode::unsupported, [&] { choose("auto"); }, {"llvmpipe", "only on request"});
  EXPECT_EQ(chosen("vulkan"), "vulkan/llvmpipe") << "asked for, it is fine";
}

TEST_F(Choosing, TheReasonTellsOfEveryOther) {
  vulkan.reason = "windows above 128 px do not fit";
  const std::string reason = choose("auto", kMany, "fft:256").reason;
  for (const char* part : {"cpu:0 (AVX2)", "vulkan:0 (llvmpipe)", "software rasteriser",
                           "vulkan:1 (GeForce One): windows above 128 px do not fit",
                           "vulkan:2 (GeForce Two)", "reference:0 (direct sums)"}) {
    EXPECT_NE(reason.find(part), std::string::npos) << part << " in: " << reason;
  }
  EXPECT_TRUE(reason.starts_with("cpu:0 (AVX2)")) << reason;
}

TEST_F(Choosing, NamesForce) {
  EXPECT_EQ(chosen("reference"), "reference/direct sums");
  EXPECT_EQ(chosen("vulkan:2"), "vulkan/GeForce Two");
  EXPECT_EQ(chosen("vulkan:Two"), "vulkan/GeForce Two");
  EXPECT_EQ(chosen("vulkan:GeForce"), "vulkan/GeForce One");
  EXPECT_EQ(chosen("cpu:0", kMany), "cpu/AVX2");
}

TEST_F(Choosing, AForcedNameNeverFallsBack) {
  cpu.broken = true;
  expect_error(ErrorCode::unsupported, [&] { choose("cpu"); }, {"its driver is too old"});
  vulkan.reason = "too large";
  expect_error(ErrorCode::unsupported, [&] { choose("vulkan:1", kMany, "fft:512"); },
               {"fft:512:hann", "too large"});
}

TEST_F(Choosing, UnknownNamesListTheChoices) {
  expect_error(ErrorCode::unavailable, [&] { choose("metal"); },
               {"\"metal\"", "auto", "vulkan", "cpu", "opencl", "reference"});
  expect_error(ErrorCode::unavailable, [&] { choose("Vulkan"); }, {"vulkan"});
  expect_error(ErrorCode::unavailable, [&] { choose("vulkan:3"); }, {"vulkan:0", "GeForce Two"});
  expect_error(ErrorCode::unavailable, [&] { choose("vulkan:Radeon"); }, {"GeForce One"});
  expect_error(ErrorCode::unavailable, [&] { choose("opencl"); },
               {"opencl", "no device", "too old"});
}

TEST_F(Choosing, AColonMustBeFollowedByADevice) {
  expect_error(ErrorCode::bad_argument, [&] { choose("cpu:"); }, {"\"cpu:\"", "cpu:INDEX"});
  expect_error(ErrorCode::unavailable, [&] { choose("metal:"); }, {"\"metal\"", "vulkan"});
}

TEST_F(Choosing, AutoTakesNoDevice) {
  for (const char* text : {"auto:1", "auto:AVX2", "auto:"}) {
    expect_error(ErrorCode::bad_argument, [&] { choose(text); }, {text, "auto takes no index"});
  }
}

TEST_F(Choosing, TheEnvironmentSpeaksWhereTheUserDoesNot) {
  ASSERT_EQ(setenv("FATHOM_BACKEND", "reference", 1), 0);
  EXPECT_EQ(chosen(""), "reference/direct sums");
  EXPECT_EQ(chosen("cpu"), "cpu/AVX2");
  EXPECT_EQ(chosen("auto"), "vulkan/GeForce One") << "auto is a choice, too";
  ASSERT_EQ(setenv("FATHOM_BACKEND", "", 1), 0);
  EXPECT_EQ(chosen(""), "vulkan/GeForce One");
  ASSERT_EQ(setenv("FATHOM_BACKEND", "abacus", 1), 0);
  expect_error(ErrorCode::unavailable, [&] { choose(""); }, {"abacus", "reference"});
}

TEST_F(Choosing, NothingAtAllIsAnError) {
  expect_error(ErrorCode::unsupported, [] { select_device({}, "auto", MetricSpec(), kMany); });
}

}  // namespace
}  // namespace fathom
