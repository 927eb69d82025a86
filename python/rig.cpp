// SPDX-License-Identifier: Apache-2.0
#include "python/rig.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <utility>

#include "python/arrays.hpp"
#include "python/errors.hpp"
#include "python/given.hpp"
#include "python/instrument.hpp"
#include "python/own_rig.hpp"
#include "python/scoring.hpp"
#include "python/stack.hpp"

namespace fathom::python {
namespace {

/// What measures on a rig, as the package hands it over.
struct Measures {
  std::string metric;
  py::object window;  ///< None or (x, y)
  int average = 1;
  std::optional<std::string> backend;
  std::optional<int> threads;
};

RigOptions options_of(const std::string& rig, const Measures& measures) {
  RigOptions options;
  options.rig = rig;
  options.metric = measures.metric;
  options.backend = measures.backend.value_or("");
  options.device.threads = thread_count(measures.threads);
  options.shot.average = measures.average;
  if (measures.average < 1) refuse(fmt::format("average is {}; it is 1 or more", measures.average));
  const MetricSpec spec = MetricSpec::parse(measures.metric);
  if (spec.outputs() != 1)
    refuse(fmt::format("metric is '{}', of {} numbers for each window; a focus needs one",
                       measures.metric, spec.outputs()));
  if (measures.window.is_none()) return options;
  const auto corner = *wished_corner(measures.window, "window");
  options.window = Window{corner.first, corner.second, spec.n};
  return options;
}

std::unique_ptr<Rig> rig_with(const RigOptions& options, Hardware hardware) {
  const CameraSettings picture = hardware.camera->settings();
  const Window window = options.window.value_or(Window{0, 0, MetricSpec::parse(options.metric).n});
  require_in_picture(window, "window", picture.width_px, picture.height_px);
  return std::make_unique<Rig>(options, std::move(hardware));
}

std::unique_ptr<Instrument> open_rig(py::handle rig, const Measures& measures) {
  const std::string text = given_text(rig, "text");
  return std::make_unique<Instrument>(options_of(text, measures), [](const RigOptions& options) {
    return rig_with(options,
                    open_hardware(options.rig, {.stop_requests = options.shot.stop_requests}));
  });
}

std::unique_ptr<Instrument> open_with(const std::string& name, const Measures& measures,
                                      Hardware hardware) {
  return std::make_unique<Instrument>(options_of(name, measures), [&](const RigOptions& options) {
    return rig_with(options, std::move(hardware));
  });
}

std::unique_ptr<Instrument> open_stack(py::handle stack, std::vector<double> positions,
                                       std::string unit, const Measures& measures) {
  return open_with("stack", measures,
                   stack_hardware(Pictures(stack, "stack"), std::move(positions), std::move(unit)));
}

/// travel: description, unit, lowest, highest, resolution, coarse_spacing, blur (or None).
LensInfo travel_of(const py::dict& travel) {
  LensInfo info;
  info.description = travel["description"].cast<std::string>();
  info.unit = travel["unit"].cast<std::string>();
  info.lowest = travel["lowest"].cast<double>();
  info.highest = travel["highest"].cast<double>();
  info.resolution = travel["resolution"].cast<double>();
  info.coarse_spacing = travel["coarse_spacing"].cast<double>();
  info.blur_px_per_unit = travel["blur"].cast<std::optional<double>>();
  return info;
}

std::unique_ptr<Instrument> open_own(const py::dict& own, const Measures& measures) {
  OwnRig rig;
  rig.snap = own["snap"];
  rig.move_to = own["move_to"];
  rig.position = own["position"];
  rig.start = own["start"].cast<double>();
  rig.exposure_ms = own["exposure_ms"].cast<double>();
  rig.stale = own["stale"].cast<int>();
  rig.travel = travel_of(own["travel"].cast<py::dict>());
  return open_with("python", measures, own_hardware(std::move(rig)));
}

}  // namespace

void bind_rig(py::module_& module) {
  py::class_<Measures>(module, "Measures")
      .def(py::init([](py::handle metric, py::object window, py::handle average, py::handle backend,
                       py::handle threads) {
        return Measures{.metric = given_text(metric, "metric"),
                        .window = std::move(window),
                        .average = given_count(average, "average"),
                        .backend = wished_text(backend, "backend"),
                        .threads = wished_count(threads, "threads")};
      }));
  module.attr("search_metric") = kSearchMetric;
  module.def("open_rig", &open_rig);
  module.def("open_stack", &open_stack);
  module.def("open_own", &open_own);
  py::class_<Instrument>(module, "Instrument")
      .def("position", &Instrument::position)
      .def("move_to",
           [](Instrument& self, py::handle position) {
             return self.move_to(given_number(position, "position"));
           })
      .def("capture",
           [](Instrument& self, py::handle position) {
             return self.capture(wished_number(position, "position"));
           })
      .def("focus",
           [](Instrument& self, const py::dict& wishes, bool stays, py::object tell, bool frames) {
             return self.focus(wishes, stays, {std::move(tell), frames});
           })
      .def("sweep",
           [](Instrument& self, py::handle from, py::handle to, py::handle step, py::object tell,
              bool frames) {
             return self.sweep(wished_number(from, "from_"), wished_number(to, "to"),
                               wished_number(step, "step"), {std::move(tell), frames});
           })
      .def("range",
           [](Instrument& self, const Calibration& calibration, const py::dict& wishes,
              py::handle repeat, bool extrapolate, py::object tell, bool frames) {
             return self.range(calibration, wishes, given_count(repeat, "repeat"), extrapolate,
                               {std::move(tell), frames});
           })
      .def("about", &Instrument::about)
      .def("place_target",
           [](Instrument& self, py::handle distance) {
             self.place_target(given_number(distance, "distance_mm"));
           })
      .def("target_mm", &Instrument::target_mm)
      .def("stop", &Instrument::stop)
      .def("close", &Instrument::close);
}

}  // namespace fathom::python
