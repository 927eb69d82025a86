// SPDX-License-Identifier: Apache-2.0
// The calibration file.
#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "calibration/blur_json.hpp"
#include "calibration/calibration.hpp"
#include "engine/error.hpp"
#include "engine/json.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fathom-calibration";
constexpr int kVersion = 2;

Json to_json(const CalibrationConditions& conditions) {
  const auto known = [](int corner) {
    return corner == CalibrationConditions::kUnknown ? Json() : Json(corner);
  };
  const Window& window = conditions.window;
  Json json = {{"rig", conditions.rig},
               {"metric", conditions.metric},
               {"window", {known(window.x), known(window.y), window.n}},
               {"unit", conditions.unit}};
  if (conditions.blur) json["blur"] = to_json(*conditions.blur);
  return json;
}

int pixels_from(const Json& json) {
  const int value = whole_from<int>(json);
  if (value >= 0) return value;
  throw Error(ErrorCode::bad_data, "a window is made of whole pixels");
}

int corner_from(const Json& json) {
  return json.is_null() ? CalibrationConditions::kUnknown : pixels_from(json);
}

/// Version 1 kept only the window's side.
CalibrationConditions conditions_from(const Json& json, int version) {
  CalibrationConditions conditions{json.at("rig"), json.at("metric"), {}, json.at("unit")};
  if (json.contains("blur")) conditions.blur = blur_from(json.at("blur"));
  if (version == 1) {
    constexpr int kUnknown = CalibrationConditions::kUnknown;
    conditions.window = {kUnknown, kUnknown, pixels_from(json.at("window_side"))};
    return conditions;
  }
  const Json& window = json.at("window");
  conditions.window = {corner_from(window.at(0)), corner_from(window.at(1)),
                       pixels_from(window.at(2))};
  return conditions;
}

/// The version of a calibration file, which this program must know.
int version_of(const Json& json) {
  if (json.at("format") == "fathom-run")
    throw Error(ErrorCode::bad_data, "it is a run, not the calibration that followed from it");
  if (json.at("format") != kFormat) {
    throw Error(ErrorCode::bad_data, "it is no calibration; calibrate again");
  }
  const Json& version = json.at("version");
  if (version == 1 || version == kVersion) return version.get<int>();
  throw Error(ErrorCode::bad_data,
              fmt::format("a calibration of version {}, and this program reads 1 to {}; calibrate "
                          "again, or use the program that made it",
                          version.dump(-1, ' ', true, Json::error_handler_t::replace), kVersion));
}

}  // namespace

std::string Calibration::json() const {
  Json parameters = Json::object(), sigmas = Json::object();
  for (const CalibrationParameter& parameter : this->parameters()) {
    parameters[parameter.name] = parameter.value;
    sigmas[parameter.name] = parameter.sigma;
  }
  Json points = Json::array();
  const auto residuals = residuals_mm(), position_residuals = this->position_residuals();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Json& point = points.emplace_back(Json{{"position", points_[i].position},
                                           {"distance_mm", points_[i].distance_mm},
                                           {"residual", position_residuals[i]},
                                           {"residual_mm", residuals[i]},
                                           {"left_out", left_out(i)}});
    if (points_[i].sigma > 0) point["sigma"] = points_[i].sigma;
    if (!points_[i].spectrum.empty()) point["spectrum"] = points_[i].spectrum;
  }
  const Json json = {{"format", kFormat},
                     {"version", kVersion},
                     {"model", to_string(model())},
                     {"parameters", parameters},
                     {"sigmas", sigmas},
                     {"r_squared", r_squared_},
                     {"position_scatter", position_scatter()},
                     {"conditions", to_json(conditions_)},
                     {"points", points}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Calibration Calibration::parse(std::string_view text, std::string_view name) {
  try {
    const Json json = parse_json(text);
    const int version = version_of(json);
    std::vector<CalibrationPoint> points;
    for (const Json& point : json.at("points")) {
      points.push_back({point.at("position"), point.at("distance_mm"), point.value("sigma", 0.0),
                        point.value("spectrum", std::vector<double>())});
    }
    return fit(parse_calibration_model(json.at("model").get<std::string>()), std::move(points),
               conditions_from(json.at("conditions"), version));
  } catch (const Json::exception&) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} is damaged or no calibration; calibrate again", name));
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace fathom
