// SPDX-License-Identifier: Apache-2.0
#include "hal/lens.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"

namespace fathom {

void require_within(const LensInfo& info, double position) {
  if (std::isnan(position)) throw Error(ErrorCode::bad_argument, "a lens position is not a number");
  if (position >= info.lowest && position <= info.highest) return;
  throw Error(ErrorCode::out_of_bounds,
              fmt::format("lens position {} {} is outside of the travel {} to {}", position,
                          info.unit, info.lowest, info.highest));
}

}  // namespace fathom
