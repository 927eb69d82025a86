// SPDX-License-Identifier: Apache-2.0
// From the runs of a calibration to its curve.
#pragma once

#include "run_file.hpp"

namespace fathom {

/// The curve through every run that focused on a target at a known distance, with what it was
/// measured with, and the lens's blur where the runs tell it. Throws as Calibration::fit.
Calibration fit_calibration(const RunFile& file, CalibrationModel model);

}  // namespace fathom
