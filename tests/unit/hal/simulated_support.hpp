// SPDX-License-Identifier: Apache-2.0
// A simulated rig and its focus quality in the default window, for the tests beside this file.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "backends/backends.hpp"
#include "engine/selection.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::test {

inline constexpr Window kMiddle{96, 88, 64};

class SimulatedRig {
 public:
  explicit SimulatedRig(const std::string& text, const std::string& metric = "fft:64")
      : hardware_(open_hardware(text)) {
    const MetricSpec spec = MetricSpec::parse(metric);
    device_ = select_device(all_backends(), "reference", spec, 1).device;
    plan_ = device_->plan(spec, 1);
  }

  Camera& camera() { return *hardware_.camera; }
  Lens& lens() { return *hardware_.lens; }
  TargetStage& stage() { return *hardware_.stage; }

  Frame grab() { return hardware_.camera->grab(std::chrono::seconds(5)).value(); }

  /// Focus quality of one frame, or of the mean of several.
  double score(int frames = 1) {
    FrameAverage average;
    for (int i = 0; i < frames; ++i) average.add(grab());
    return plan_->score(average.mean(), kMiddle);
  }

  double score_at(double position) {
    hardware_.lens->move_to(position);
    return score();
  }

 private:
  Hardware hardware_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<Plan> plan_;
};

/// Grey values of a frame, row by row.
inline std::vector<std::uint32_t> pixels(const Frame& frame) {
  std::vector<std::uint32_t> values;
  for (int y = 0; y < frame.height_px(); ++y) {
    for (int x = 0; x < frame.width_px(); ++x) values.push_back(frame.at(x, y));
  }
  return values;
}

}  // namespace fathom::test
