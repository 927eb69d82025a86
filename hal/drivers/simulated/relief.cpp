// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/simulated/relief.hpp"

#include <algorithm>
#include <cmath>

#include "engine/optics.hpp"
#include "hal/drivers/simulated/discs.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"

namespace fathom::simulated {
namespace {

/// A larger disc shows nothing more of a texture, and costs more.
constexpr double kLargestRadiusPx = 48;

/// How much of a pixel lies inside an edge that passes its centre at so many pixels.
double part_inside(double inside_px) { return std::clamp(0.5 + inside_px, 0.0, 1.0); }

/// Pixels from a range of the field that a picture needs.
struct Field {
  int left = 0, right = 0;  ///< First column, and the one after the last.
};

int sheets_of(Target target, const ReliefShape& shape) {
  if (target == Target::stair) return shape.steps;
  return target == Target::sphere ? 2 : 1;
}

/// A sheet over what was seen without it.
void cover(std::vector<float>& seen, const std::vector<Spread>& sheet) {
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Spread& here = sheet[i];
    const float most = std::max(here.weight, 1.0f);
    seen[i] = here.light / most + (1 - here.weight / most) * seen[i];
  }
}

/// The farthest sheet has no end: where discs differ in size, their weights are not quite 1.
std::vector<float> backdrop(const std::vector<Spread>& sheet) {
  std::vector<float> seen(sheet.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (sheet[i].weight > 0) seen[i] = sheet[i].light / sheet[i].weight;
  }
  return seen;
}

}  // namespace

bool is_relief(Target target) {
  return target == Target::slant || target == Target::stair || target == Target::sphere;
}

/// One surface. Places are pixels of the picture.
class Relief::Sheet {
 public:
  Sheet(const Relief& relief, int number)
      : relief_(relief), number_(number), texture_(relief.textures_[number]) {}

  /// From 0 to 1.
  double covered(double x, double y) const {
    if (number_ == 0) return 1;
    if (relief_.target_ == Target::stair) return part_inside(x - edge_px(number_));
    return part_inside(radius_px() - std::hypot(x - kMiddleXPx, y - kMiddleYPx));
  }

  double distance_mm(double x, double y) const {
    const ReliefShape& shape = relief_.shape_;
    switch (relief_.target_) {
      case Target::slant:
        return relief_.distance_mm_ + shape.slope_mm * (x - kMiddleXPx);
      case Target::stair:
        return relief_.distance_mm_ + shape.step_mm * ((shape.steps - 1) / 2.0 - number_);
      case Target::sphere:
        return relief_.distance_mm_ + (number_ == 0 ? 2 * shape.radius_mm : depth_of_ball(x, y));
      case Target::usaf:
      case Target::seedling:
      case Target::orange:
      case Target::blank:
        break;
    }
    return relief_.distance_mm_;
  }

  double reflectance(double x, double y) const {
    return texture_.at((x - kMiddleXPx) * relief_.mm_per_px_,
                       (y - kMiddleYPx) * relief_.mm_per_px_);
  }

  /// The columns in which it can be seen where every edge is blurred by so much.
  Field columns(int blur_px, double growth) const {
    Field field{-blur_px, kWidthPx + blur_px};
    if (relief_.target_ != Target::stair) return field;
    const auto seen_at = [growth](double x) { return kMiddleXPx + growth * (x - kMiddleXPx); };
    if (number_ > 0)
      field.left = std::max(field.left, static_cast<int>(seen_at(edge_px(number_))) - 1);
    // Behind the next one it still shows through that one's blurred edge.
    if (number_ + 1 < relief_.shape_.steps) {
      const int last = static_cast<int>(seen_at(edge_px(number_ + 1))) + 2 * blur_px + 2;
      field.right = std::min(field.right, last);
    }
    return field;
  }

 private:
  /// Where band `number` of the stair begins.
  double edge_px(int number) const {
    return number * static_cast<double>(kWidthPx) / relief_.shape_.steps - 0.5;
  }
  double radius_px() const { return relief_.shape_.radius_mm / relief_.mm_per_px_; }
  double depth_of_ball(double x, double y) const {
    const double r = relief_.shape_.radius_mm;
    const double aside = relief_.mm_per_px_ * std::hypot(x - kMiddleXPx, y - kMiddleYPx);
    return r - std::sqrt(std::max(r * r - aside * aside, 0.0));
  }

  const Relief& relief_;
  int number_;
  const Texture& texture_;
};

Relief::Relief(Target target, const ReliefShape& shape, double distance_mm, std::uint64_t seed)
    : target_(target),
      shape_(shape),
      distance_mm_(distance_mm),
      mm_per_px_(kPitchMm / magnification(distance_mm)) {
  // The picture is smallest, and shows most, with the lens at infinity.
  constexpr double kMostShownPx = 1.2 * (kWidthPx / 2.0 + kLargestRadiusPx);
  for (int sheet = 0; sheet < sheets_of(target, shape); ++sheet)
    textures_.emplace_back(seed, sheet, mm_per_px_, kMostShownPx * mm_per_px_);
}

Relief::Sheet Relief::sheet(int number) const { return {*this, number}; }

double Relief::distance_mm(double x_px, double y_px) const {
  for (int number = sheet_count() - 1; number > 0; --number) {
    const Sheet nearer = sheet(number);
    if (nearer.covered(x_px, y_px) >= 0.5) return nearer.distance_mm(x_px, y_px);
  }
  return sheet(0).distance_mm(x_px, y_px);
}

/// How much larger the picture is than with the lens focused at the target's distance.
double Relief::growth(int lens_steps) const {
  if (!shape_.breathes) return 1;
  return (kFocalLengthMm + extension_mm(lens_steps)) /
         optics::image_distance_mm(kFocalLengthMm, distance_mm_);
}

std::vector<float> Relief::picture(int lens_steps, double f_number) const {
  const double growth = this->growth(lens_steps);
  const auto radius_px = [&](double distance_mm) {
    return std::min(kLargestRadiusPx,
                    disc_of_confusion_mm(lens_steps, distance_mm, f_number) / (2 * kPitchMm));
  };
  std::vector<float> seen;
  for (int number = 0; number < sheet_count(); ++number) {
    const Sheet sheet = this->sheet(number);
    // Of a plane the ends are blurred most; the ball's blur lies between its pole and the plane.
    const double blur_px = std::max({radius_px(sheet.distance_mm(-kLargestRadiusPx, kMiddleYPx)),
                                     radius_px(sheet.distance_mm(kMiddleXPx, kMiddleYPx)),
                                     radius_px(sheet.distance_mm(kWidthPx + kLargestRadiusPx, 0))});
    const int margin = static_cast<int>(std::ceil(blur_px)) + 1;
    const Field columns = sheet.columns(static_cast<int>(kLargestRadiusPx), growth);
    Discs discs;
    for (int row = -margin; row < kHeightPx + margin; ++row) {
      const double y = kMiddleYPx + (row - kMiddleYPx) / growth;
      for (int col = std::max(columns.left, -margin);
           col < std::min(columns.right, kWidthPx + margin); ++col) {
        const double x = kMiddleXPx + (col - kMiddleXPx) / growth;
        const double part = sheet.covered(x, y);
        if (part > 0)
          discs.add(col, row, radius_px(sheet.distance_mm(x, y)), sheet.reflectance(x, y), part);
      }
    }
    const std::vector<Spread> spread = discs.sum();
    if (number == 0) {
      seen = backdrop(spread);
    } else {
      cover(seen, spread);
    }
  }
  return seen;
}

}  // namespace fathom::simulated
