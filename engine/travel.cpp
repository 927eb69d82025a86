// SPDX-License-Identifier: Apache-2.0
#include "engine/travel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/error.hpp"

namespace fathom {

void require_within(const LensInfo& info, double position) {
  if (std::isnan(position)) throw Error(ErrorCode::bad_argument, "a lens position is not a number");
  if (position >= info.lowest && position <= info.highest) return;
  throw Error(ErrorCode::out_of_bounds,
              fmt::format("lens position {} {} is outside of the travel {} to {}", position,
                          info.unit, info.lowest, info.highest));
}

double nearest_position(const LensInfo& info, double position) {
  if (info.stops.empty()) {
    const double steps = std::ceil((position - info.lowest) / info.resolution - 0.5);
    return std::clamp(info.lowest + steps * info.resolution, info.lowest, info.highest);
  }
  const auto above = std::lower_bound(info.stops.begin(), info.stops.end(), position);
  if (above == info.stops.begin()) return info.stops.front();
  if (above == info.stops.end()) return info.stops.back();
  const double below = *std::prev(above);
  return position - below <= *above - position ? below : *above;
}

std::string nearest_name(const LensInfo& info, double position) {
  if (info.stop_names.size() != info.stops.size() || info.stops.empty()) return {};
  const auto at =
      std::lower_bound(info.stops.begin(), info.stops.end(), nearest_position(info, position));
  return info.stop_names[static_cast<std::size_t>(at - info.stops.begin())];
}

}  // namespace fathom
