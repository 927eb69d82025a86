// SPDX-License-Identifier: Apache-2.0
// A pine seedling. The tape measures to its stem, the needles stand in front: so it reads slightly
// near, as the thesis' seedling did (tables I and II).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/drivers/simulated/random.hpp"
#include "hal/drivers/simulated/scene.hpp"

namespace fathom::simulated {
namespace {

constexpr double kTopMm = -170;
constexpr double kBottomMm = 170;
constexpr double kStemReflectance = 0.10;

/// A card of needles and the mean distance between two of them along the stem.
struct Whorl {
  double in_front_mm;
  double spacing_mm;
  double reflectance;  ///< Nearer needles catch more light.
};
constexpr Whorl kWhorls[] = {{2.5, 1.8, 0.24}, {5, 2.2, 0.31}, {9, 4.5, 0.37}};

double stem_x_mm(double y_mm) { return 2.5 * std::sin(y_mm / 60); }

/// Bent slightly upward, thinner towards the tip, brightest along its middle.
struct Needle {
  double x_mm, y_mm, length_mm, half_width_mm, bend_mm, cosine, sine, reflectance;

  /// Place along the needle and beside its middle line.
  std::pair<double, double> local(double x, double y) const {
    const double along = (x - x_mm) * cosine + (y - y_mm) * sine;
    const double part = along / length_mm;
    const double beside = (y - y_mm) * cosine - (x - x_mm) * sine;
    return {along, beside - 4 * bend_mm * part * (1 - part)};
  }

  double half_width_at(double along_mm) const {
    const double part = std::clamp(along_mm / length_mm, 0.0, 1.0);
    return half_width_mm * (1 - 0.8 * part * part * part);
  }

  double signed_distance(double x, double y) const {
    const auto [along, beside] = local(x, y);
    return std::max({std::abs(beside) - half_width_at(along), -along, along - length_mm});
  }

  double shade(double x, double y) const {
    const auto [along, beside] = local(x, y);
    const double part = std::clamp(beside / half_width_at(along), -1.0, 1.0);
    return reflectance * (0.7 + 0.5 * std::sqrt(1 - part * part));
  }
};

Needle grow_needle(Random& random, double y_mm, double reflectance) {
  const bool to_the_left = random.uniform() < 0.5;
  const double rise = random.uniform(5, 65) * std::numbers::pi / 180;
  Needle needle{};
  needle.x_mm = stem_x_mm(y_mm);
  needle.y_mm = y_mm;
  needle.length_mm = random.uniform(30, 60);
  needle.half_width_mm = random.uniform(0.3, 0.5);
  needle.bend_mm = random.uniform(-3, 3);
  needle.cosine = (to_the_left ? -1 : 1) * std::cos(rise);
  needle.sine = -std::sin(rise);  // rows count downward
  needle.reflectance = reflectance * random.uniform(0.75, 1.25);
  return needle;
}

void draw_needle(Layer& layer, const Needle& needle) {
  const double tip_x = needle.x_mm + needle.length_mm * needle.cosine;
  const double tip_y = needle.y_mm + needle.length_mm * needle.sine;
  const double margin = std::abs(needle.bend_mm) + needle.half_width_mm;
  layer.paint(
      std::min(needle.x_mm, tip_x) - margin, std::min(needle.y_mm, tip_y) - margin,
      std::max(needle.x_mm, tip_x) + margin, std::max(needle.y_mm, tip_y) + margin,
      [&](double x, double y) { return needle.signed_distance(x, y); },
      [&](double x, double y) { return needle.shade(x, y); });
}

void draw_stem(Layer& layer) {
  const double half_width_mm = 1.6;
  const auto beside = [](double x, double y) { return std::abs(x - stem_x_mm(y)); };
  layer.paint(
      -5, kTopMm, 5, kBottomMm, [&](double x, double y) { return beside(x, y) - half_width_mm; },
      [&](double x, double y) {
        const double scales = 1 + 0.3 * std::sin(y * 2.1) * std::cos(3 * x + y);
        return kStemReflectance * scales *
               (1.3 - 0.6 * std::min(beside(x, y) / half_width_mm, 1.0));
      });
}

}  // namespace

void draw_seedling(Scene& scene, double cell_mm, std::uint64_t seed) {
  draw_stem(scene.layers.emplace_back(0.0, cell_mm));
  Random random(seed, Stream::scene);
  for (const Whorl& whorl : kWhorls) {
    Layer& layer = scene.layers.emplace_back(whorl.in_front_mm, cell_mm);
    for (double y = kTopMm; y < kBottomMm; y += whorl.spacing_mm * random.uniform(0.5, 1.5)) {
      draw_needle(layer, grow_needle(random, y, whorl.reflectance));
    }
  }
}

}  // namespace fathom::simulated
