// SPDX-License-Identifier: Apache-2.0
// What is known of the lens's blur, said in one line, and kept where the program keeps things.
#pragma once

#include "session/lens_blur.hpp"

namespace fathom::cli {

/// calibration: may be null. The rig must outlive it.
LensBlur lens_blur(Rig& rig, const FocusRequest& request, const Calibration* calibration = nullptr);

}  // namespace fathom::cli
