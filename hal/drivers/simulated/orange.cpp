// SPDX-License-Identifier: Apache-2.0
// An orange: smooth shading and dimples so faint that a small window hardly finds a focus (the
// thesis: a patch of rind "had too little contrast to converge").
#include <algorithm>
#include <cmath>

#include "hal/drivers/simulated/random.hpp"
#include "hal/drivers/simulated/scene.hpp"

namespace fathom::simulated {
namespace {

constexpr double kRadiusMm = 39;
constexpr double kReflectance = 0.5;
constexpr double kDimpleSpacingMm = 1.9;
constexpr double kDimpleRadiusMm = 0.7;
constexpr double kDimpleContrast = 0.12;

/// Slices of the sphere, the farthest first: each is a disc that shows what no nearer one hides.
/// Its card stands behind the nearest point of the orange, to which the tape measures.
struct Slice {
  double radius_mm;
  double behind_mm;
};
constexpr Slice kSlices[] = {{kRadiusMm, 14}, {24, 5}, {13, 1}};

/// Darkening by the dimple of one cell of a jittered grid on the rind.
double dimple(std::uint64_t seed, int column, int row, double across, double down) {
  Random random(seed, Stream::scene, static_cast<std::uint64_t>(row) * 4096 + column);
  const double x = across - (column + random.uniform()) * kDimpleSpacingMm;
  const double y = down - (row + random.uniform()) * kDimpleSpacingMm;
  const double squared = (x * x + y * y) / (kDimpleRadiusMm * kDimpleRadiusMm);
  if (squared >= 1) return 0;
  // The slope that faces the light is brighter, the other darker, the floor a little darker.
  const double slope = (x + y) / kDimpleRadiusMm;
  return (1 - squared) * (1 - squared) * (0.5 + slope) * kDimpleContrast;
}

double rind(std::uint64_t seed, double x_mm, double y_mm) {
  const double side = std::clamp(x_mm / kRadiusMm, -1.0, 1.0);
  const double up = std::clamp(y_mm / kRadiusMm, -1.0, 1.0);
  const double towards = std::sqrt(std::max(1 - side * side - up * up, 0.0));
  const double light = 0.25 + 0.75 * std::max(0.85 * towards - 0.35 * side - 0.4 * up, 0.0);
  // Arc lengths keep the dimples' spacing on the sphere; the offset keeps cell numbers positive.
  const double across = kRadiusMm * (2 + std::asin(side)), down = kRadiusMm * (2 + std::asin(up));
  const int column = static_cast<int>(across / kDimpleSpacingMm);
  const int row = static_cast<int>(down / kDimpleSpacingMm);
  double dark = 0;
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = column - 1; c <= column + 1; ++c) dark += dimple(seed, c, r, across, down);
  }
  return kReflectance * light * (1 - dark);
}

}  // namespace

void draw_orange(Scene& scene, double cell_mm, std::uint64_t seed) {
  for (const Slice& slice : kSlices) {
    const double r = slice.radius_mm;
    scene.layers.emplace_back(-slice.behind_mm, cell_mm)
        .paint(
            -r, -r, r, r, [r](double x, double y) { return std::hypot(x, y) - r; },
            [seed](double x, double y) { return rind(seed, x, y); });
  }
}

}  // namespace fathom::simulated
