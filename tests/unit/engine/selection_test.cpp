// SPDX-License-Identifier: Apache-2.0
// The choice of a backend, with backends that exist only here.
#include "engine/selection.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

/// A device that is listed, opened and asked, but never computes.
class FakeDevice final : public Device {
 public:
  FakeDevice(const DeviceInfo& info, std::string reason)
      : Device(info), reason_(std::move(reason)) {}
  std::string unsupported(const MetricSpec& spec) const override {
    return spec.n > 128 ? reason_ : std::string();
  }

 private:
  std::unique_ptr<Plan> do_plan(const MetricSpec&, std::size_t) override { return nullptr; }
  std::string reason_;
};

struct FakeBackend final : Backend {
  FakeBackend(const char* its_name, std::vector<DeviceInfo> its_devices)
      : own_name(its_name), infos(std::move(its_devices)) {}
  const char* name() const noexcept override { return own_name; }
  std::vector<DeviceInfo> devices() const override { return infos; }
  std::unique_ptr<Device> open(std::size_t index, const DeviceOptions&) const override {
    if (broken) throw Error(ErrorCode::unavailable, "its driver is too old");
    return std::make_unique<FakeDevice>(infos.at(index), reason);
  }

  const char* own_name;
  std::vector<DeviceInfo> infos;
  bool broken = false;
  std::string reason;  ///< Why it declines windows above 128 px; empty: it does not.
};

class Choosing : public ::testing::Test {
 protected:
  void SetUp() override { unsetenv("FATHOM_BACKEND"); }
  void TearDown() override { unsetenv("FATHOM_BACKEND"); }

  Selection choose(std::string_view text, Workload workload = Workload::batches,
                   const char* metric = "fft:64") const {
    const Backend* const table[] = {&vulkan, &cpu, &none, &reference};
    return select_device(table, text, MetricSpec::parse(metric), workload);
  }
  /// "BACKEND/DEVICE" of what was chosen.
  std::string chosen(std::string_view text, Workload workload = Workload::batches,
                     const char* metric = "fft:64") const {
    const Selection selection = choose(text, workload, metric);
    EXPECT_EQ(selection.reason.find('\n'), std::string::npos);
    return selection.backend + "/" + selection.device->info().name;
  }

  FakeBackend vulkan{"vulkan",
                     {{"llvmpipe", DeviceKind::software, ""},
                      {"GeForce One", DeviceKind::gpu, ""},
                      {"GeForce Two", DeviceKind::gpu, ""}}};
  FakeBackend cpu{"cpu", {{"AVX2", DeviceKind::cpu, ""}}};
  FakeBackend none{"opencl", {}};
  FakeBackend reference{"reference", {{"direct sums", DeviceKind::cpu, ""}}};
};

TEST_F(Choosing, AutoTakesAGpuForBatchesAndTheCpuForSingleWindows) {
  for (const char* text : {"auto", ""}) {
    EXPECT_EQ(chosen(text, Workload::batches), "vulkan/GeForce One");
    EXPECT_EQ(chosen(text, Workload::single_windows), "cpu/AVX2");
  }
}

TEST_F(Choosing, AutoFallsBackInOrder) {
  cpu.broken = true;
  EXPECT_EQ(chosen("auto", Workload::single_windows), "reference/direct sums");
  vulkan.broken = true;
  EXPECT_EQ(chosen("auto", Workload::batches), "reference/direct sums");
  vulkan.broken = false;
  cpu.infos.clear();
  reference.infos.clear();
  EXPECT_EQ(chosen("auto", Workload::single_windows), "vulkan/GeForce One");
}

TEST_F(Choosing, AutoNeverTakesASoftwareRasteriser) {
  vulkan.infos.resize(1);
  EXPECT_EQ(chosen("auto", Workload::batches), "cpu/AVX2");
  cpu.infos.clear();
  reference.infos.clear();
  expect_error(ErrorCode::unsupported, [&] { choose("auto"); }, {"llvmpipe", "only on request"});
  EXPECT_EQ(chosen("vulkan"), "vulkan/llvmpipe") << "asked for, it is fine";
}

TEST_F(Choosing, TheReasonTellsOfEveryOther) {
  vulkan.reason = "windows above 128 px do not fit";
  const std::string reason = choose("auto", Workload::batches, "fft:256").reason;
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
  EXPECT_EQ(chosen("cpu:0", Workload::batches), "cpu/AVX2");
}

TEST_F(Choosing, AForcedNameNeverFallsBack) {
  cpu.broken = true;
  expect_error(ErrorCode::unsupported, [&] { choose("cpu"); }, {"its driver is too old"});
  vulkan.reason = "too large";
  expect_error(ErrorCode::unsupported, [&] { choose("vulkan:1", Workload::batches, "fft:512"); },
               {"fft:512:hann", "too large"});
}

TEST_F(Choosing, UnknownNamesListTheChoices) {
  expect_error(ErrorCode::unavailable, [&] { choose("metal"); },
               {"\"metal\"", "auto", "vulkan", "cpu", "opencl", "reference"});
  expect_error(ErrorCode::unavailable, [&] { choose("Vulkan"); }, {"vulkan"});
  expect_error(ErrorCode::unavailable, [&] { choose("vulkan:3"); }, {"vulkan:0", "GeForce Two"});
  expect_error(ErrorCode::unavailable, [&] { choose("vulkan:Radeon"); }, {"GeForce One"});
  expect_error(ErrorCode::unavailable, [&] { choose("opencl"); }, {"opencl", "no device"});
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
  expect_error(ErrorCode::unsupported,
               [] { select_device({}, "auto", MetricSpec(), Workload::batches); });
}

}  // namespace
}  // namespace fathom
