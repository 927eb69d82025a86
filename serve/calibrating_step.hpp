// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "serve/procedures.hpp"
#include "session/lens_blur.hpp"
#include "session/run_keeper.hpp"

namespace fathom::serve {

/// Asks for one distance after the other, focuses at each, and fits the curve in the end. Its file
/// goes below the folder. Throws as Session::focus and Calibration::fit, and what next_step throws.
void calibrate(Work& work, Rig& rig, LensBlur& blur, RunKeeper& keeper, Observer& all,
               Outcome& outcome);

}  // namespace fathom::serve
