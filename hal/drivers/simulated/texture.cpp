// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/drivers/simulated/random.hpp"

namespace fathom::simulated {
namespace {

constexpr double kFinestMm = 0.1, kCoarsestMm = 30;
constexpr float kContrast = 0.5f;  ///< Of one octave, from its darkest to its brightest.

/// The cubic B-spline's weights of four neighbours; t from the second one, 0 to 1.
std::array<float, 4> spline(float t) {
  const float back = 1 - t;
  return {back * back * back / 6, 2.0f / 3 - t * t * (1 - t / 2),
          2.0f / 3 - back * back * (1 - back / 2), t * t * t / 6};
}

/// -0.5 to 0.5, of a point of a lattice.
float value_at(std::uint64_t seed, std::int64_t column, std::int64_t row) {
  const auto place =
      static_cast<std::uint64_t>(row) * 0x9e3779b1u + static_cast<std::uint64_t>(column);
  return static_cast<float>(static_cast<double>(mix(seed ^ mix(place)) >> 11) * 0x1p-53 - 0.5);
}

}  // namespace

Texture::Octave::Octave(std::uint64_t seed, double spacing, double shift, double reach_mm)
    : spacing_mm(spacing), aside(shift) {
  const int reach = static_cast<int>(reach_mm / spacing + std::abs(shift)) + 3;
  first = -reach;
  side = 2 * reach + 1;
  values.reserve(static_cast<std::size_t>(side) * side);
  for (int row = first; row < first + side; ++row) {
    for (int column = first; column < first + side; ++column)
      values.push_back(value_at(seed, column, row));
  }
}

float Texture::Octave::at(double x_mm, double y_mm) const {
  const double x = x_mm / spacing_mm + aside - first, y = y_mm / spacing_mm - aside - first;
  const int column = std::clamp(static_cast<int>(x), 1, side - 3);
  const int row = std::clamp(static_cast<int>(y), 1, side - 3);
  const auto across = spline(static_cast<float>(x - column));
  const auto down = spline(static_cast<float>(y - row));
  float sum = 0;
  for (int j = 0; j < 4; ++j) {
    const float* const v =
        values.data() + static_cast<std::size_t>(row - 1 + j) * side + column - 1;
    sum += down[j] * (across[0] * v[0] + across[1] * v[1] + across[2] * v[2] + across[3] * v[3]);
  }
  return sum;
}

Texture::Texture(std::uint64_t seed, int which, double finest_mm, double reach_mm) {
  std::uint64_t own =
      mix(mix(seed) + static_cast<std::uint64_t>(Stream::scene) + 64 * (which + 1ull));
  double shift = 0;
  for (double spacing = kFinestMm; spacing <= kCoarsestMm; spacing *= 2) {
    ++own;
    // The lattices must not share a line, which would be seen.
    shift += 0.618034;
    if (spacing >= finest_mm) octaves_.emplace_back(own, spacing, shift, reach_mm);
  }
}

double Texture::at(double x_mm, double y_mm) const {
  float sum = 0.5f;
  for (const Octave& octave : octaves_) sum += kContrast * octave.at(x_mm, y_mm);
  return std::clamp(sum, 0.02f, 0.98f);
}

}  // namespace fathom::simulated
