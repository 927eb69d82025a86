// SPDX-License-Identifier: Apache-2.0
#include "hal/glass.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/error.hpp"

namespace fathom {

Glass dragged(const Glass& before, double motor, const Play& play) {
  return {std::clamp(before.lowest, motor, motor + play.least),
          std::clamp(before.highest, motor, motor + play.most)};
}

void require_known(const Exposure& exposure, const KnownTime& known) {
  if (exposure.start_ns < known.since_ns) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("an exposure that began at {} ns is older than this motion, which "
                            "found the lens at rest since {} ns; have camera and lens one clock?",
                            exposure.start_ns, known.since_ns));
  }
  if (exposure.end_ns > known.now_ns) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("an exposure that ends at {} ns is not over, it is {} ns now; have "
                            "camera and lens one clock?",
                            exposure.end_ns, known.now_ns));
  }
  if (known.lost_ns && exposure.end_ns > *known.lost_ns) {
    throw Error(ErrorCode::unavailable,
                "the motor failed on the way, so where the lens stood then is not known");
  }
}

}  // namespace fathom
