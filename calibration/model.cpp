// SPDX-License-Identifier: Apache-2.0
#include "calibration/model.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {

std::span<const CalibrationModel> calibration_models() {
  static const std::vector<CalibrationModel> models = [] {
    std::vector<CalibrationModel> all;
    for (const CalibrationFormula* formula : calibration_formulas()) all.emplace_back(*formula);
    return all;
  }();
  return models;
}

const char* to_string(CalibrationModel model) noexcept { return model.formula().name; }

CalibrationModel parse_calibration_model(std::string_view name,
                                         std::span<const CalibrationModel> models) {
  std::string names;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (name == to_string(models[i])) return models[i];
    const char* const before = i == 0 ? "" : i + 1 < models.size() ? ", " : " and ";
    names += before + std::string(to_string(models[i]));
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("no calibration model \"{}\"; there are {}", name, names));
}

int parameter_count(CalibrationModel model) { return model.formula().parameters; }

}  // namespace fathom
