// SPDX-License-Identifier: Apache-2.0
// Where the glass is, behind gears with play, and of which times that is known: what every record of a
// move (hal/step_log.hpp, hal/drivers/serial/track.hpp) has in common.
#pragma once

#include <cstdint>
#include <optional>

#include "motion.hpp"

namespace fathom {

/// The play of a motor's gears, in the lens's unit: as much as is known of it.
struct Play {
  double least = 0;
  double most = 0;
};

/// The lowest and the highest place where the glass can be.
struct Glass {
  double lowest, highest;

  double middle() const { return (lowest + highest) / 2; }
  double width() const { return highest - lowest; }
};

/// Gears with play p drag the glass along: for a motor at m, glass at g is moved to
/// clamp(g, m, m + p). That grows with p, so the least and the most play give the two bounds.
Glass dragged(const Glass& before, double motor, const Play& play);

/// Variance of a place that is anywhere between two bounds.
inline double variance_within(double width) { return width * width / 12; }

/// The time of which a motion knows where the lens stood.
struct KnownTime {
  std::int64_t since_ns;  ///< The lens stood then, and from then on.
  std::int64_t now_ns;
  std::optional<std::int64_t> lost_ns = {};  ///< The move failed then.
};

/// Throws what Motion::during does for an exposure outside of that time.
void require_known(const Exposure& exposure, const KnownTime& known);

}  // namespace fathom
