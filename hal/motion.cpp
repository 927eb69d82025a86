// SPDX-License-Identifier: Apache-2.0
#include "hal/motion.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {

Where Motion::during(const Exposure& exposure) const {
  if (exposure.start_ns == 0 && exposure.end_ns == 0) {
    throw Error(ErrorCode::bad_argument,
                "nobody stamped this exposure, so where the lens stood in it is not known");
  }
  if (exposure.end_ns < exposure.start_ns) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("an exposure from {} to {} ns ends before it starts", exposure.start_ns,
                            exposure.end_ns));
  }
  return do_during(exposure);
}

}  // namespace fathom
