// SPDX-License-Identifier: Apache-2.0
#include "focus/patch_relief.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

namespace fathom {
namespace {

/// Of x = -(n - 1) / 2 .. (n - 1) / 2.
double sum_of_squares(int n) { return (static_cast<double>(n) * n - 1) * n / 12; }

}  // namespace

Patch centred(Patch patch) {
  double sum = 0;
  for (const float grey : patch.greys) sum += grey;
  const auto mean = static_cast<float>(sum / static_cast<double>(patch.greys.size()));
  for (float& grey : patch.greys) grey -= mean;
  return patch;
}

PatchRelief::PatchRelief(const Patch& patch)
    : width_(patch.width), height_(patch.height), relief_(centred(patch).greys) {
  for (int x = 0; x < width_; ++x)
    places_.push_back(static_cast<float>(x) - static_cast<float>(width_ - 1) / 2);
  const Sums sums = sums_of({width_, height_, relief_}, 0, 0);
  const double mean = sums.b / count(), slope_x = sums.bx / xx(), slope_y = sums.by / yy();
  float* relief = relief_.data();
  for (int y = 0; y < height_; ++y) {
    const double at_middle = mean + slope_y * (y - (height_ - 1) / 2.0);
    for (const float place : places_) *relief++ -= static_cast<float>(at_middle + slope_x * place);
  }
  for (const float r : relief_) squares_ += static_cast<double>(r) * r;
}

double PatchRelief::left_by(const Patch& other, int x, int y) const {
  const Sums sums = sums_of(other, x, y);
  const double bb =
      sums.bb - sums.b * sums.b / count() - sums.bx * sums.bx / xx() - sums.by * sums.by / yy();
  if (!(squares_ > 0 && bb > 0 && sums.ab > 0)) return 1;
  return std::max(0.0, 1 - sums.ab * sums.ab / (squares_ * bb));
}

/// A row is summed in several parts at once.
PatchRelief::Sums PatchRelief::sums_of(const Patch& other, int from_x, int from_y) const {
  constexpr int kAtOnce = 8;
  using Part = Eigen::Array<float, kAtOnce, 1>;
  const auto part_at = [](const float* values) { return Eigen::Map<const Part>(values); };
  Sums sums;
  for (int y = 0; y < height_; ++y) {
    const float* const row =
        other.greys.data() + static_cast<std::size_t>(y + from_y) * other.width + from_x;
    const float* const own = relief_.data() + static_cast<std::size_t>(y) * width_;
    Part ab = Part::Zero(), b = Part::Zero(), bx = Part::Zero(), bb = Part::Zero();
    int x = 0;
    for (; x + kAtOnce <= width_; x += kAtOnce) {
      const Part there = part_at(row + x);
      ab += part_at(own + x) * there;
      b += there;
      bx += part_at(places_.data() + x) * there;
      bb += there * there;
    }
    for (; x < width_; ++x) {
      ab[0] += own[x] * row[x];
      b[0] += row[x];
      bx[0] += places_[x] * row[x];
      bb[0] += row[x] * row[x];
    }
    sums.ab += ab.cast<double>().sum();
    sums.bx += bx.cast<double>().sum();
    sums.bb += bb.cast<double>().sum();
    const double of_row = b.cast<double>().sum();
    sums.b += of_row;
    sums.by += of_row * (y - (height_ - 1) / 2.0);
  }
  return sums;
}

double PatchRelief::xx() const { return sum_of_squares(width_) * height_; }
double PatchRelief::yy() const { return sum_of_squares(height_) * width_; }

}  // namespace fathom
