// SPDX-License-Identifier: Apache-2.0
#include "python/calibrating.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "calibration/calibration.hpp"
#include "calibration/choice.hpp"
#include "engine/error.hpp"
#include "engine/file.hpp"
#include "python/errors.hpp"
#include "python/given.hpp"

namespace fathom::python {
namespace {

namespace py = pybind11;
using Numbers = std::vector<double>;

template <class Value>
Value known(const py::dict& conditions, const char* name, Value otherwise) {
  return conditions.contains(name) ? conditions[name].cast<Value>() : otherwise;
}

CalibrationConditions conditions_of(const py::dict& given) {
  CalibrationConditions conditions;
  conditions.rig = known<std::string>(given, "rig", "");
  conditions.metric = known<std::string>(given, "metric", "");
  conditions.unit = known<std::string>(given, "unit", "");
  if (given.contains("window")) {
    const auto [x, y, n] = given["window"].cast<std::tuple<int, int, int>>();
    conditions.window = {x, y, n};
  }
  return conditions;
}

std::vector<CalibrationPoint> points_of(const Numbers& positions, const Numbers& distances_mm,
                                        const Numbers& sigmas,
                                        const std::vector<Numbers>& spectra) {
  if (positions.size() != distances_mm.size()) {
    refuse(fmt::format("positions holds {} numbers, and distances_mm {}", positions.size(),
                       distances_mm.size()));
  }
  if (sigmas.size() != positions.size()) {
    refuse(
        fmt::format("positions holds {} numbers, and sigmas {}", positions.size(), sigmas.size()));
  }
  std::vector<CalibrationPoint> points;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    points.push_back(
        {positions[i], distances_mm[i], sigmas[i], i < spectra.size() ? spectra[i] : Numbers()});
  }
  return points;
}

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const CalibrationModel model : calibration_models()) names.emplace_back(to_string(model));
  return names;
}

Calibration fit(const Numbers& positions, const Numbers& distances_mm, const Numbers& sigmas,
                const std::vector<Numbers>& spectra, py::handle model, const py::dict& conditions) {
  std::vector<CalibrationPoint> points = points_of(positions, distances_mm, sigmas, spectra);
  const CalibrationModel chosen =
      model.is_none() ? choose_calibration_model(points).model
                      : calibration_models()[given_choice(model, "model", model_names())];
  return Calibration::fit(chosen, std::move(points), conditions_of(conditions));
}

Calibration load(const std::string& path) {
  constexpr std::uintmax_t kLargest = 64 << 20;
  return Calibration::parse(read_file(path, kLargest), path);
}

py::dict parameters_of(const Calibration& calibration) {
  py::dict parameters;
  for (const CalibrationParameter& one : calibration.parameters())
    parameters[py::str(one.name)] = py::make_tuple(one.value, one.sigma);
  return parameters;
}

py::dict conditions_dict(const Calibration& calibration) {
  const CalibrationConditions& made = calibration.conditions();
  return py::dict(py::arg("rig") = made.rig, py::arg("metric") = made.metric,
                  py::arg("unit") = made.unit,
                  py::arg("window") = py::make_tuple(made.window.x, made.window.y, made.window.n));
}

py::list points_list(const Calibration& calibration) {
  py::list points;
  for (std::size_t i = 0; i < calibration.points().size(); ++i) {
    const CalibrationPoint& point = calibration.points()[i];
    points.append(
        py::make_tuple(point.position, point.distance_mm, point.sigma, calibration.left_out(i)));
  }
  return points;
}

py::tuple distance(const Calibration& calibration, double position, double sigma,
                   bool extrapolate) {
  if (!(sigma >= 0)) refuse(fmt::format("sigma is {}; it is 0 or more", sigma));
  if (!extrapolate && !calibration.covers(position)) {
    throw Error(
        ErrorCode::out_of_bounds,
        fmt::format("position {} is outside of the calibration, {} to {}; calibrate there, or "
                    "give extrapolate=True",
                    position, calibration.lowest_position(), calibration.highest_position()));
  }
  const Distance found = calibration.distance(position, calibration.run_sigma(sigma));
  return py::make_tuple(found.mm, found.sigma_mm);
}

py::tuple interval(const Calibration& calibration, double position, double coverage) {
  if (!(coverage > 0 && coverage < 1))
    refuse(fmt::format("coverage is {}; it is between 0 and 1", coverage));
  const DistanceInterval found = calibration.interval(position, coverage);
  return py::make_tuple(found.low_mm, found.high_mm);
}

}  // namespace

void bind_calibrating(py::module_& module) {
  module.def("calibration_models", &model_names);
  py::class_<Calibration>(module, "Calibration")
      .def_static("fit", &fit)
      .def_static("load", &load)
      .def("save",
           [](const Calibration& self, const std::string& path) { write_file(path, self.json()); })
      .def("json", &Calibration::json)
      .def_static("parse",
                  [](const std::string& json) { return Calibration::parse(json, "calibration"); })
      .def_property_readonly("model",
                             [](const Calibration& self) { return to_string(self.model()); })
      .def_property_readonly("equation", &Calibration::equation)
      .def_property_readonly("parameters", &parameters_of)
      .def_property_readonly("conditions", &conditions_dict)
      .def_property_readonly("points", &points_list)
      .def_property_readonly("r_squared", &Calibration::r_squared)
      .def_property_readonly("freedom", &Calibration::freedom)
      .def_property_readonly("position_scatter", &Calibration::position_scatter)
      .def_property_readonly("lowest_position", &Calibration::lowest_position)
      .def_property_readonly("highest_position", &Calibration::highest_position)
      .def("covers", &Calibration::covers)
      .def("position_for", &Calibration::position_for)
      .def("distance_mm", &Calibration::distance_mm)
      .def("distance", &distance)
      .def("interval", &interval);
}

}  // namespace fathom::python
