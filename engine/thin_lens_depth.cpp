// SPDX-License-Identifier: Apache-2.0
#include "engine/thin_lens_depth.hpp"

#include <cmath>
#include <limits>

namespace fathom::optics {

DepthOfField thin_lens_depth_of_field(const Optics& optics, double object_mm) {
  depth_of_field(optics, object_mm);  // throws for what no lens has
  const double squared = optics.focal_mm * optics.focal_mm;
  const double blur = optics.f_number * optics.circle_mm;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (std::isinf(object_mm)) return {squared / blur, kInfinity};
  const double part = blur * (object_mm - optics.focal_mm) / squared;
  return {object_mm / (1 + part), part < 1 ? object_mm / (1 - part) : kInfinity};
}

}  // namespace fathom::optics
