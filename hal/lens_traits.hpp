// SPDX-License-Identifier: Apache-2.0
// What every real lens is told in its rig file, under the same keys.
#pragma once

#include <cstdint>
#include <optional>

#include "lens.hpp"
#include "rig_driver.hpp"

namespace fathom {

/// Keys: settle_ms, backlash, coarse (in the lens's unit), blur_px (that a unit of travel adds), and
/// focal_mm, f_number and circle_um, all three or none. `fathom rigs check` measures the first three.
struct LensTraits {
  double settle_ms = 0;           ///< From the motor's stop to a picture that no longer changes.
  double backlash = 0;            ///< How far a downward move goes too far and comes back.
  double coarse_spacing = 0;      ///< LensInfo::coarse_spacing; 0 where nobody knows.
  std::optional<double> blur_px;  ///< LensInfo::blur_px_per_unit.
  std::optional<Optics> optics;

  /// `usual`: what holds where a key is absent. Throws Error(bad_argument).
  static LensTraits read(const RigSettings& settings, const LensTraits& usual);

  std::int64_t settle_ns() const { return static_cast<std::int64_t>(settle_ms * 1e6); }

  /// Fills coarse_spacing and optics of `info`, whose travel and resolution must be set. Without
  /// `coarse`, optics and unit cannot tell a spacing: it stays 0, and a search finds it by halving.
  void describe(LensInfo& info) const;
};

}  // namespace fathom
