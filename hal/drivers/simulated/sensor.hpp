// SPDX-License-Identifier: Apache-2.0
// From light to grey values: noise, fixed pattern and the slow drift of the lamp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace fathom::simulated {

/// Exposure at which a white card is just below the brightest grey value.
inline constexpr double kNormalExposureMs = 20;

/// Light of the lamp at a time, 1 on average: it wanders within +-1 % times `amount`, smoothly
/// over minutes. Frames taken in a row share it, so averaging them does not remove it (thesis T12).
class Lamp {
 public:
  Lamp(std::uint64_t seed, double amount);
  double light_at(std::int64_t time_ns) const;

 private:
  struct Wave {
    double amplitude, period_s, phase;
  };
  std::vector<Wave> waves_;
};

/// An 8-bit sensor whose noise is set so that focus quality repeats as the thesis measured (T12).
class Sensor {
 public:
  /// noise: multiplies shot noise, read noise and fixed pattern; 0 is a perfect sensor.
  Sensor(std::uint64_t seed, double noise);

  /// Grey values of one frame. reflectance: what every pixel sees, [row][col]; light: of the lamp,
  /// 1 is normal; number: of the frame, which selects its noise.
  std::vector<std::uint8_t> expose(std::span<const float> reflectance, double light,
                                   double exposure_ms, std::uint64_t number) const;

 private:
  std::uint64_t seed_;
  double noise_;
  std::vector<float> gain_;    ///< Sensitivity of every pixel, about 1.
  std::vector<float> offset_;  ///< Dark level of every pixel, grey values.
};

}  // namespace fathom::simulated
