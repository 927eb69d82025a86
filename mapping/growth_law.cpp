// SPDX-License-Identifier: Apache-2.0
#include "mapping/growth_law.hpp"

#include <utility>

namespace fathom::mapping {

std::optional<GrowthLaw> growth_law(Alignment alignment, const GrowthWitnesses& told,
                                    std::vector<double> positions) {
  if (alignment != Alignment::scale || positions.empty()) return std::nullopt;
  std::optional<Growth> growth;
  if (told.calibration) growth = growth_of(*told.calibration, positions.front(), told.optics);
  if (!growth && told.optics && told.lens_blur) growth = growth_of(*told.optics, *told.lens_blur);
  if (!growth || !(growth->sigma > 0)) return std::nullopt;
  return GrowthLaw{
      .per_unit = growth->per_unit, .sigma = growth->sigma, .positions = std::move(positions)};
}

}  // namespace fathom::mapping
