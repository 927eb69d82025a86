// SPDX-License-Identifier: Apache-2.0
// Whether there is light enough, too much, or light that changes from picture to picture: looked at
// before anything is believed. A webcam whose automatic exposure is switched off may keep one from
// another time of day.
#pragma once

#include <optional>

#include "../engine/frame.hpp"
#include "../engine/window.hpp"
#include "warning.hpp"

namespace fathom {

/// Takes in pictures of one place, and tells what is wrong with their light.
class LightMeter {
 public:
  explicit LightMeter(const Window& window) : window_(window) {}

  void see(const Frame& frame);

  /// The worst of what was seen, or nothing. exposure_ms: of the camera; 0 where it has none.
  std::optional<PoorLight> judge(double exposure_ms) const;

 private:
  Window window_;
  int frames_ = 0;
  double sum_ = 0;  // of the pictures' mean grey values, of full scale
  double least_ = 0, most_ = 0;
  double highest_ = 0;  // pixel, of full scale
  double saturated_ = 0;
};

}  // namespace fathom
