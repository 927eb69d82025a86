// SPDX-License-Identifier: Apache-2.0
#include "depth/moments.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::depth {
namespace {

constexpr double kNarrow = 1e-9;

}  // namespace

void Moments::add_area(double x, double y, double pixels, double texture) {
  area_ += pixels;
  x_ += pixels * x;
  y_ += pixels * y;
  texture_ += texture;
}

void Moments::add_position(double x, double y, double position, double noise, double weight) {
  const std::array<double, 3> terms = {1, x, y};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) normal_[i][j] += weight * terms[i] * terms[j];
    right_[i] += weight * terms[i] * position;
  }
  square_ += weight * position * position;
  variance_ += weight * noise * noise;
}

Moments& Moments::operator+=(const Moments& other) {
  area_ += other.area_;
  x_ += other.x_;
  y_ += other.y_;
  texture_ += other.texture_;
  square_ += other.square_;
  variance_ += other.variance_;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) normal_[i][j] += other.normal_[i][j];
    right_[i] += other.right_[i];
  }
  return *this;
}

Moments::Central Moments::central() const {
  const double all = normal_[0][0], x = normal_[0][1] / all, y = normal_[0][2] / all;
  const double z = right_[0] / all;
  return {.x = x,
          .y = y,
          .xx = normal_[1][1] / all - x * x,
          .xy = normal_[1][2] / all - x * y,
          .yy = normal_[2][2] / all - y * y,
          .xz = right_[1] / all - x * z,
          .yz = right_[2] / all - y * z};
}

double Moments::noise(double reach_px) const {
  const double all = normal_[0][0];
  const double independent = std::max(all / (reach_px * reach_px), 1.0);
  return std::sqrt(variance_ / all / independent);
}

PartPlane Moments::plane(double reach_px) const {
  const Central c = central();
  PartPlane plane{.x = c.x,
                  .y = c.y,
                  .position = right_[0] / normal_[0][0],
                  .sigma = noise(reach_px),
                  .slope_x = 0,
                  .slope_y = 0};
  // Level across what is too narrow to tell.
  const double determinant = c.xx * c.yy - c.xy * c.xy;
  if (!(determinant > kNarrow * c.xx * c.yy)) {
    plane.slope_x = c.xx > 0 ? c.xz / c.xx : 0;
    plane.slope_y = c.xx > 0 || !(c.yy > 0) ? 0 : c.yz / c.yy;
    return plane;
  }
  plane.slope_x = (c.xz * c.yy - c.yz * c.xy) / determinant;
  plane.slope_y = (c.yz * c.xx - c.xz * c.xy) / determinant;
  plane.slope_sigma_x = plane.sigma * std::sqrt(c.yy / determinant);
  plane.slope_sigma_y = plane.sigma * std::sqrt(c.xx / determinant);
  return plane;
}

void Moments::write(SeenSurface& surface, double shared_sigma, double reach_px,
                    double texture) const {
  const double all = normal_[0][0];
  const PartPlane fitted = plane(reach_px);
  surface.area_px = static_cast<std::size_t>(area_);
  surface.centre_x = x_ / area_;
  surface.centre_y = y_ / area_;
  surface.position = fitted.position;
  const double squared = std::max(square_ / all - fitted.position * fitted.position, 0.0);
  surface.spread = std::sqrt(squared);
  surface.relief = std::sqrt(std::max(squared - variance_ / all, 0.0));
  surface.sigma = std::hypot(fitted.sigma, shared_sigma);
  surface.texture = texture > 0 ? texture_ / texture : 0;
  surface.slope_x = fitted.slope_x;
  surface.slope_y = fitted.slope_y;
}

}  // namespace fathom::depth
