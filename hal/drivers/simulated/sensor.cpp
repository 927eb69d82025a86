// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/drivers/simulated/random.hpp"
#include "hal/drivers/simulated/scene.hpp"

namespace fathom::simulated {
namespace {

constexpr double kWhiteGrey = 240;  ///< Grey values of a perfectly white card over black.
constexpr double kBlackGrey = 4;    ///< Grey value of darkness.
constexpr double kElectronsPerGrey = 80;
constexpr double kReadGrey = 0.75;  ///< Read noise, deviation in grey values.
constexpr double kGainDeviation = 0.004;
constexpr double kOffsetDeviation = 0.4;  ///< Grey values.

}  // namespace

Lamp::Lamp(std::uint64_t seed, double amount) {
  Random random(seed, Stream::drift);
  const auto add_wave = [&](double amplitude, double period_s) {
    const double phase = random.uniform(0, 2 * std::numbers::pi);
    waves_.push_back({amplitude * amount, period_s * random.uniform(0.9, 1.1), phase});
  };
  add_wave(0.005, 1130);
  add_wave(0.003, 410);
  add_wave(0.002, 170);
}

double Lamp::light_at(std::int64_t time_ns) const {
  double light = 1;
  for (const Wave& wave : waves_) {
    const double turns = static_cast<double>(time_ns) * 1e-9 / wave.period_s;
    light += wave.amplitude * std::sin(2 * std::numbers::pi * turns + wave.phase);
  }
  return light;
}

Sensor::Sensor(std::uint64_t seed, double noise) : seed_(seed), noise_(noise) {
  Random random(seed, Stream::fixed_pattern);
  for (int i = 0; i < kWidthPx * kHeightPx; ++i) {
    gain_.push_back(static_cast<float>(1 + noise * kGainDeviation * random.gaussian()));
    offset_.push_back(
        static_cast<float>(kBlackGrey + noise * kOffsetDeviation * random.gaussian()));
  }
}

std::vector<std::uint8_t> Sensor::expose(std::span<const float> reflectance, double light,
                                         double exposure_ms, std::uint64_t number) const {
  Random random(seed_, Stream::frame_noise, number);
  const double grey_per_reflectance = kWhiteGrey * light * exposure_ms / kNormalExposureMs;
  std::vector<std::uint8_t> pixels(reflectance.size());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const double signal = grey_per_reflectance * gain_[i] * reflectance[i];
    double grey = signal + offset_[i];
    if (noise_ > 0) {
      // Hundreds of electrons make a grey value: their Poisson noise is a Gaussian's.
      const double shot_variance = std::max(signal, 0.0) / kElectronsPerGrey;
      grey += noise_ * std::sqrt(shot_variance + kReadGrey * kReadGrey) * random.gaussian();
    }
    pixels[i] = static_cast<std::uint8_t>(std::clamp(std::nearbyint(grey), 0.0, 255.0));
  }
  return pixels;
}

}  // namespace fathom::simulated
