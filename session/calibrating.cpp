// SPDX-License-Identifier: Apache-2.0
#include "session/calibrating.hpp"

#include <utility>

#include "session/blur_store.hpp"
#include "session/ranging.hpp"

namespace fathom {

Calibration fit_calibration(const RunFile& file, CalibrationModel model) {
  CalibrationConditions conditions = conditions_of(file.setup);
  if (const auto learned = blur_of(file.runs)) conditions.blur = learned->model;
  return Calibration::fit(model, calibration_points(file.runs), std::move(conditions));
}

}  // namespace fathom
