// SPDX-License-Identifier: Apache-2.0
// A camera that sees where a made-up lens truly is: every place is another grey.
#pragma once

#include <functional>
#include <string>

#include "hal/camera.hpp"

namespace fathom::test {

/// Where the lens stood over an exposure, in its unit.
using MeanPlace = std::function<double(const Exposure&)>;

/// Frames are exposed when they are asked for, on the computer's own clock.
class PlaceCamera final : public Camera {
 public:
  PlaceCamera(std::string description, MeanPlace mean)
      : description_(std::move(description)), mean_(std::move(mean)) {}

  std::string description() const override { return description_; }
  CameraSettings settings() const override { return settings_; }
  bool is_live() const override { return true; }
  Validity validate(CameraSettings& wished) const override;
  void apply(const CameraSettings& settings) override;
  std::optional<Frame> grab(std::chrono::milliseconds timeout) override;

 private:
  std::string description_;
  MeanPlace mean_;
  CameraSettings settings_{24, 16, Depth::bits16, 5};
};

}  // namespace fathom::test
