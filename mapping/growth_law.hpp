// SPDX-License-Identifier: Apache-2.0
// What is known of a picture's growth before its frames are seen.
#pragma once

#include <optional>
#include <vector>

#include "calibration/growth.hpp"
#include "depth/align.hpp"
#include "engine/optics.hpp"

namespace fathom::mapping {

/// Who may tell it: a calibration first, then the lens's own optics and blur.
struct GrowthWitnesses {
  std::optional<Calibration> calibration = std::nullopt;
  std::optional<Optics> optics = std::nullopt;
  std::optional<BlurModel> lens_blur = std::nullopt;
};

/// The law that an alignment by scale begins with; positions: of the frames, as they will come.
/// Nothing for other alignments, and where nobody tells it: then its frames alone do.
std::optional<GrowthLaw> growth_law(Alignment alignment, const GrowthWitnesses& told,
                                    std::vector<double> positions);

}  // namespace fathom::mapping
