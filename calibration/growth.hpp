// SPDX-License-Identifier: Apache-2.0
// By how much the picture grows as a lens moves (thin lens): as the distance from lens to sensor does.
#pragma once

#include <optional>

#include "../engine/optics.hpp"
#include "../focus/blur.hpp"
#include "calibration.hpp"

namespace fathom {

/// For each unit of position, as a part of the picture at one of them.
struct Growth {
  double per_unit = 0;
  double sigma = 0;  ///< Standard uncertainty.
};

/// At a position, by the distances of a calibration and the focal length; where nobody says that, a
/// thin lens's fit tells it. The lens's way is taken to go with its position. Nothing where neither
/// tells it.
std::optional<Growth> growth_of(const Calibration& calibration, double position,
                                const std::optional<Optics>& optics);

/// By optics and blur alone, which know neither a pixel's size nor which way is out: the size of the
/// growth, no more, with a pixel as large as the circle of confusion.
Growth growth_of(const Optics& optics, const BlurModel& blur);

}  // namespace fathom
