// SPDX-License-Identifier: Apache-2.0
#include "bench/honesty/kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/honesty/grain.hpp"
#include "bench/honesty/recording.hpp"
#include "bench/honesty/thesis_rig.hpp"
#include "session/rig.hpp"

namespace fathom::honesty {

namespace {

/// A run on the simulated rig: with these keys beside target, seed and distance.
Scene simulated(std::mt19937& random, const std::string& metric, const std::string& target,
                const std::string& keys, bool is_still = false,
                const std::optional<Window>& window = {}) {
  const double distance = pick(random, 1400, 2600);
  Scene scene;
  const std::string still =
      fmt::format("sim:target={},distance={:.2f},seed={}", target, distance, random() % 1000000);
  scene.text = still + fmt::format(",start={}{}", random() % 1200, keys);
  scene.hardware = open_hardware(scene.text);
  scene.metric = metric;
  scene.window = window;
  const bool is_blank = target == "blank";
  // The stage belongs to the hardware, which the rig keeps until the truth has been asked for.
  TargetStage* const stage = scene.hardware.stage.get();
  const double before =
      !is_still ? 0 : sharpest(still, metric, window, distance) - steps_of(distance);
  scene.truth = [stage, is_blank, before]() -> std::optional<double> {
    if (is_blank) return std::nullopt;
    return steps_of(stage->distance_mm()) + before;
  };
  scene.wrong = half_depth_in_steps(distance);
  return scene;
}

std::string any_noise(std::mt19937& random) {
  return fmt::format(",noise={:.2f}", pick(random, 0.5, 2));
}

const char* textured(std::mt19937& random) {
  constexpr const char* kTargets[] = {"usaf", "seedling", "orange"};
  return kTargets[random() % 3];
}

template <const char* const& Target>
Scene undisturbed(std::mt19937& random, const std::string& metric) {
  return simulated(random, metric, Target, any_noise(random), std::string(Target) != "blank");
}
constexpr const char* kUsaf = "usaf";
constexpr const char* kSeedling = "seedling";
constexpr const char* kOrange = "orange";
constexpr const char* kBlank = "blank";

Scene moving(std::mt19937& random, const std::string& metric) {
  const double speed = pick(random, 15, 58) * (random() % 2 == 0 ? 1 : -1);
  return simulated(random, metric, textured(random), fmt::format(",speed={:.1f}", speed));
}
Scene slowly_moving(std::mt19937& random, const std::string& metric) {
  const double speed = pick(random, 1, 15) * (random() % 2 == 0 ? 1 : -1);
  return simulated(random, metric, textured(random), fmt::format(",speed={:.1f}", speed));
}
Scene too_fast(std::mt19937& random, const std::string& metric) {
  return simulated(random, metric, textured(random),
                   fmt::format(",rate={:.1f}", pick(random, 52, 76)));
}
Scene loses_steps(std::mt19937& random, const std::string& metric) {
  return simulated(random, metric, textured(random), fmt::format(",lose={}", 5 + random() % 100));
}
Scene left_out(std::mt19937& random, const std::string& metric) {
  Scene scene = simulated(random, metric, textured(random), any_noise(random));
  const double focus = *scene.truth(), length = pick(random, 60, 300);
  const double away = pick(random, 90, 350) + length / 2;
  const double middle = random() % 2 == 0 && focus - away > 60 ? focus - away : focus + away;
  const double low = std::clamp(std::round(middle - length / 2), 0.0, 1100.0);
  scene.request = FocusRequest::within(low, std::min(std::round(low + length), 1200.0));
  scene.truth = [focus, request = scene.request]() -> std::optional<double> {
    if (*request.from < focus && focus < *request.to) return focus;
    return std::nullopt;
  };
  scene.text += fmt::format(" --from {} --to {}", *scene.request.from, *scene.request.to);
  return scene;
}
Scene near_darkness(std::mt19937& random, const std::string& metric) {
  return simulated(
      random, metric, "blank",
      fmt::format(",noise={:.2f},exposure_ms={:.2f}", pick(random, 0.1, 0.3), pick(random, 1, 20)));
}
Scene overexposed(std::mt19937& random, const std::string& metric) {
  return simulated(random, metric, textured(random),
                   any_noise(random) + fmt::format(",exposure_ms={:.1f}", pick(random, 35, 120)),
                   true);
}
Scene drifting(std::mt19937& random, const std::string& metric) {
  return simulated(random, metric, textured(random),
                   fmt::format(",drift={:.1f}", pick(random, 5, 30)), true);
}
Scene small_windows(std::mt19937& random, const std::string& metric) {
  const int n = 8 << random() % 3;
  const Window window{static_cast<int>(random() % (256 - n)),
                      static_cast<int>(random() % (240 - n)), n};
  Scene scene = simulated(random, fmt::format("{}:{}", metric, n), textured(random),
                          any_noise(random), true, window);
  scene.text += " --window " + to_string(window);
  return scene;
}
Scene narrow_bands(std::mt19937& random, const std::string& metric) {
  const double low = pick(random, 0, 0.3), high = low + pick(random, 0.03, 0.15);
  const char* const power = random() % 2 == 0 ? ":power" : "";
  return simulated(random, fmt::format("{}:64{}:band={:.2f}-{:.2f}", metric, power, low, high),
                   textured(random), any_noise(random), true);
}

/// A square of random texture that repeats beyond its edges, and what a lens makes of it.
class Texture {
 public:
  static constexpr int kSide = 64;

  /// sigma_px: how smooth; grey values from `low` to `high`.
  Texture(std::mt19937& random, double sigma_px, double low, double high) : greys_(kSide * kSide) {
    for (double& grey : greys_) grey = gaussian(random);
    greys_ = blurred(sigma_px);
    const auto [least, most] = std::minmax_element(greys_.begin(), greys_.end());
    const double from = *least, by = (high - low) / (*most - *least);
    for (double& grey : greys_) grey = low + (grey - from) * by;
  }

  static double gaussian(std::mt19937& random) {
    const double radius = std::sqrt(-2 * std::log(pick(random, 1e-12, 1)));
    return radius * std::cos(2 * std::numbers::pi * pick(random, 0, 1));
  }

  std::vector<double> blurred(double sigma_px) const {
    if (sigma_px < 0.05) return greys_;
    std::vector<double> kernel(kSide);  // of the circle that the texture is
    double sum = 0;
    for (int i = 0; i < kSide; ++i) {
      for (int turn = -3; turn <= 3; ++turn)
        kernel[i] += std::exp(-0.5 * std::pow((i + turn * kSide) / sigma_px, 2));
      sum += kernel[i];
    }
    for (double& k : kernel) k /= sum;
    return along(along(greys_, kernel, 1, kSide), kernel, kSide, 1);
  }

 private:
  static std::vector<double> along(const std::vector<double>& from,
                                   const std::vector<double>& kernel, int step, int line) {
    std::vector<double> to(from.size());
    for (int l = 0; l < kSide; ++l) {
      for (int i = 0; i < kSide; ++i) {
        double sum = 0;
        for (int k = 0; k < kSide; ++k) sum += kernel[k] * from[l * line + (i + k) % kSide * step];
        to[l * line + i * step] = sum;
      }
    }
    return to;
  }

  std::vector<double> greys_;
};

/// How a camera sees, and keeps, a picture.
struct Look {
  double gain = 1, noise = 0;  ///< Of noise, its deviation in grey values.
  Grain grain = Grain::white;
  double strength = 0;  ///< As grained() takes it,
  double usual = 0;     ///< with the deviation that it was set for.
};

Frame shot(std::vector<double> greys, const Look& look, std::mt19937& random) {
  for (double& grey : greys) grey = look.gain * grey + look.noise * Texture::gaussian(random);
  greys = grained(std::move(greys), Texture::kSide, look.grain, look.strength, look.usual);
  std::vector<std::uint8_t> pixels;
  for (const double grey : greys)
    pixels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(grey), 0.0, 255.0)));
  return Frame(Texture::kSide, Texture::kSide, std::move(pixels));
}

/// Where something is most.
enum class Ramp { hump, first, last };

struct Recorded {
  double low = 30, high = 200;   ///< Grey values of the texture.
  double gain_hump = 0;          ///< Of the light, round a place of its own.
  double noise_hump = 0;         ///< Added to the noise there,
  Ramp noise_ramp = Ramp::hump;  ///< or towards an end.
  Grain grain = Grain::white;
  bool is_blank = false;
  int fewest = 5, most = 40;  ///< Pictures.
};

double share_of(Ramp ramp, double bell, int picture, int count) {
  const double part = static_cast<double>(picture) / (count - 1);
  switch (ramp) {
    case Ramp::hump:
      return bell;
    case Ramp::first:
      return 1 - part;
    case Ramp::last:
      return part;
  }
  return 0;
}

Scene recorded(std::mt19937& random, const std::string& metric, const Recorded& wish) {
  const int count = wish.fewest + static_cast<int>(random() % (wish.most - wish.fewest + 1));
  const double margin = std::min(2.0, (count - 1) / 4.0);
  const double best = pick(random, margin, count - 1 - margin);
  const double blur = std::exp(pick(random, std::log(0.25), std::log(1.8)));  // px a picture
  const double noise = pick(random, 0.5, 3), left = pick(random, 0, 1);
  const double hump = pick(random, 0, count - 1), width = pick(random, 1.5, count / 3.0);
  const Texture texture(random, std::exp(pick(random, std::log(0.6), std::log(2.0))), wish.low,
                        wish.high);
  const double strength = wish.grain == Grain::white ? 0 : pick(random, 0, 1);
  std::vector<Frame> pictures;
  std::vector<double> positions;
  for (int p = 0; p < count; ++p) {
    const double bell = std::exp(-std::pow((p - hump) / width, 2));
    const double noisy = share_of(wish.noise_ramp, bell, p, count);
    const auto greys = wish.is_blank ? std::vector<double>(Texture::kSide * Texture::kSide, 150.)
                                     : texture.blurred(std::hypot(blur * (p - best), left));
    pictures.push_back(shot(greys,
                            {.gain = 1 + wish.gain_hump * bell,
                             .noise = noise * (1 + wish.noise_hump * noisy),
                             .grain = wish.grain,
                             .strength = strength,
                             .usual = noise},
                            random));
    positions.push_back(p);
  }
  Scene scene;
  scene.hardware = play(std::move(pictures), std::move(positions));
  scene.metric = metric;
  scene.text = fmt::format("{} pictures, blur {:.2f} px, noise {:.1f}, left {:.1f}", count, blur,
                           noise, left);
  scene.truth = [best, blank = wish.is_blank]() -> std::optional<double> {
    if (blank) return std::nullopt;
    return best;
  };
  scene.wrong = 1.5;
  return scene;
}

Scene few_pictures(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric, {.most = 9});
}
Scene many_pictures(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric, {.fewest = 10});
}
Scene faint_texture(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric, {.low = 140, .high = 160});
}
Scene swelling_light(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric, {.gain_hump = pick(random, -0.15, 0.15)});
}
Scene swelling_light_faint(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric,
                  {.low = 144, .high = 156, .gain_hump = pick(random, -0.15, 0.15), .fewest = 10});
}
Scene blank_swelling(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric, {.gain_hump = pick(random, -0.15, 0.15), .is_blank = true});
}
Scene blank_noise(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric, {.noise_hump = pick(random, 0.2, 3), .is_blank = true});
}

/// Noise that neighbours share, on a blank card.
template <Grain grain>
Scene blank_grain(std::mt19937& random, const std::string& metric) {
  constexpr Ramp kRamps[] = {Ramp::hump, Ramp::hump, Ramp::first, Ramp::last};
  const Ramp ramp = kRamps[random() % 4];
  return recorded(
      random, metric,
      {.noise_hump = pick(random, 0.3, 4), .noise_ramp = ramp, .grain = grain, .is_blank = true});
}
/// The same on a texture, steady.
Scene kept_as_jpeg(std::mt19937& random, const std::string& metric) {
  return recorded(random, metric, {.grain = Grain::jpeg, .fewest = 10});
}

constexpr Kind kKinds[] = {
    {"undisturbed, chart", true, true, undisturbed<kUsaf>},
    {"undisturbed, seedling", true, true, undisturbed<kSeedling>},
    {"undisturbed, orange", true, true, undisturbed<kOrange>},
    {"blank card", false, true, undisturbed<kBlank>},
    {"recording, 5 to 9 pictures", true, true, few_pictures},
    {"recording, 10 to 40 pictures", true, true, many_pictures},
    {"recording, faint", true, true, faint_texture},
    {"recording, light swells", true, true, swelling_light},
    {"recording, faint, light swells", true, true, swelling_light_faint},
    {"recording, blank, light swells", false, true, blank_swelling},
    {"recording, blank, noise swells", false, true, blank_noise},
    {"recording, jpeg", true, true, kept_as_jpeg},
    // Where all but a few blocks of a JPEG are flat, those look like an object.
    {"recording, blank, jpeg-noise", false, true, blank_grain<Grain::jpeg>, 0.5},
    {"recording, blank, demosaiced", false, true, blank_grain<Grain::demosaiced>},
    {"recording, blank, smoothed", false, true, blank_grain<Grain::smoothed>},
    {"recording, blank, denoised", false, true, blank_grain<Grain::denoised>},
    {"target moves fast", false, true, moving},
    {"target moves slowly", false, true, slowly_moving},
    {"motor too fast", false, false, too_fast},
    {"steps lost", false, false, loses_steps},
    {"focus not in the range", false, true, left_out},
    {"blank card in near darkness", false, true, near_darkness},
    {"overexposed", true, true, overexposed},
    {"light drifts", true, true, drifting},
    {"small windows", true, true, small_windows},
    {"narrow bands", true, true, narrow_bands},
};

}  // namespace

std::span<const Kind> kinds() { return kKinds; }

}  // namespace fathom::honesty
