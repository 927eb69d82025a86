// SPDX-License-Identifier: Apache-2.0
// The fixture that runs every case on every device of every backend.
//
// A test names its cases (metric, picture, seed) and a body; each() runs the body on the device
// under test, so that a new backend is tested by being in the table, and nowhere else.
//
// Environment:
//   FATHOM_REQUIRE_BACKENDS=reference,cpu
//       a backend of that list that is missing fails, not skips
//   FATHOM_CONFORMANCE=DEVICE/SPEC/PICTURE/seed=S
//       only matching cases; every failure prints its own. Parts may be left out from the right, or
//       be "*"
//   FATHOM_GOLDEN_FILE=PATH
//       tests/golden/golden.txt, where the program was taken to another machine
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/backend.hpp"
#include "tests/support/frames.hpp"

namespace fathom::conformance {

/// One device of one backend, as listed.
struct DeviceUnderTest {
  const Backend* backend = nullptr;
  std::size_t index = 0;
  DeviceInfo info;

  std::string label() const;  ///< "reference:0", what --backend takes.
  bool is_reference() const;
};

/// How GoogleTest shows it.
void PrintTo(const DeviceUnderTest& device, std::ostream* out);

/// Every device of every backend, listed once when the program starts.
const std::vector<DeviceUnderTest>& devices_under_test();

/// Whether FATHOM_REQUIRE_BACKENDS names this backend.
bool is_required(const std::string& backend_name);

/// Whether FATHOM_CONFORMANCE restricts the run.
bool is_filtered();

/// The golden values: where the program runs on another machine than that which built it, the
/// environment says so.
const char* golden_file();

/// What one check is about; its text is what FATHOM_CONFORMANCE takes.
struct Case {
  MetricSpec spec;
  std::string content = "random";  ///< One of test::contents().
  int bits = 8;
  std::uint64_t seed = 7;

  /// "fft:64:hann/random8/seed=7"
  std::string text() const;
  /// The case's picture, of any size.
  test::Pixels pixels(int width, int height) const {
    return test::make_pixels(content, bits, width, height, seed);
  }
  Frame frame(int width, int height) const { return test::to_frame(pixels(width, height)); }
  /// The picture that the window fills.
  Frame frame() const { return frame(spec.n, spec.n); }
};

/// Cases of every given metric text with every given picture, such as "random8" or
/// "natural16".
std::vector<Case> cases(const std::vector<std::string>& specs,
                        const std::vector<std::string>& pictures, std::uint64_t seed = 7);

class Conformance : public ::testing::TestWithParam<DeviceUnderTest> {
 protected:
  using Body = std::function<void(const Case&, Plan&)>;

  void SetUp() override;

  Device& device() { return *device_; }

  /// Largest relative error that this device may show in a metric; 0 asks for the last bit.
  double tolerance(const MetricSpec& spec) const;

  /// Runs the body for each case that FATHOM_CONFORMANCE selects and the device takes, on a plan of
  /// that capacity. Counts what the device declines; fails if that, unfiltered, leaves no case.
  void each(const std::vector<Case>& cases, std::size_t capacity, const Body& body);

  /// A plan of this device for a check that needs several. The metric must be supported.
  std::unique_ptr<Plan> plan(const MetricSpec& spec, std::size_t capacity) {
    return device_->plan(spec, capacity);
  }

  /// The oracle's plan for a metric.
  static std::unique_ptr<Plan> oracle(const MetricSpec& spec, std::size_t capacity = 1);

  /// The oracle's score of the picture that a case's window fills. Remembered, because the oracle
  /// takes its time and every device asks for the same cases.
  static double oracle_score(const Case& tested);

 private:
  std::shared_ptr<Device> device_;
};

/// Registers a fixture for every device under test.
#define FATHOM_EVERY_DEVICE(fixture)                                                         \
  GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(fixture);                                    \
  INSTANTIATE_TEST_SUITE_P(Device, fixture,                                                  \
                           ::testing::ValuesIn(::fathom::conformance::devices_under_test()), \
                           [](const auto& tested) {                                          \
                             return std::string(tested.param.backend->name()) + "_" +        \
                                    std::to_string(tested.param.index);                      \
                           })

/// Metrics of small and typical sizes with every option, for checks of behaviour rather than
/// numbers.
std::vector<std::string> typical_specs();

/// Metrics of large windows, which backends may compute by other means, for checks that compare a
/// device with itself: the oracle is slow at these sizes.
std::vector<std::string> large_specs();

}  // namespace fathom::conformance
