// SPDX-License-Identifier: Apache-2.0
// The rigs that the suite runs on: at least one for every driver of this build.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/rig_driver.hpp"

namespace fathom::test {

struct RigFixture {
  std::string label;   ///< Names the test: letters, digits and underscores.
  std::string driver;  ///< Whose conformance it shows.
  std::string text;    ///< What open_hardware takes.
  /// Whether two frames of one place are alike to the last bit, so that a place can be recognised.
  bool is_noiseless = false;
  /// Of a rig that needs more than this machine has: what, in words. `text` is then the name of an
  /// environment variable that holds the rig text where it is there; elsewhere the tests skip.
  std::string needs = {};
  /// How a rig that no text names is opened; null: by its text.
  Hardware (*open)(const OpenOptions& options) = nullptr;
};

/// To add a driver to the suite, add a line to fixtures.cpp.
std::vector<RigFixture> rig_fixtures();

/// The name of a fixture's tests.
inline std::string fixture_label(const testing::TestParamInfo<RigFixture>& fixture) {
  return fixture.param.label;
}

/// Opens the fixture's rig anew for every test.
class RigConformance : public testing::TestWithParam<RigFixture> {
 protected:
  void SetUp() override;

  /// The rig text of this fixture.
  std::string rig_text() const;
  /// Another rig of this fixture. What the last one held must have been given back.
  Hardware open(const OpenOptions& options = {}) const;

  /// The next frame; a test failure and an empty frame if none comes.
  Frame grab();
  /// The first frame whose exposure began at or after a time.
  Frame grab_after(std::int64_t settled_ns);

  Camera& camera() { return *rig_.camera; }
  Lens& lens() { return *rig_.lens; }

  Hardware rig_;
};

/// The frame's pixels, row by row.
std::vector<std::uint32_t> pixels_of(const Frame& frame);

}  // namespace fathom::test
