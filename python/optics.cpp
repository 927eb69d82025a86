// SPDX-License-Identifier: Apache-2.0
#include "python/optics.hpp"

#include "engine/optics.hpp"

namespace fathom::python {
namespace {

namespace py = pybind11;
using py::arg;

/// Those of a lens whose circle of confusion is not asked for take any.
constexpr double kAnyCircle_mm = 1;

}  // namespace

void bind_optics(py::module_& parent) {
  py::module_ module = parent.def_submodule("optics");
  module.def("image_distance_mm", &optics::image_distance_mm, arg("focal_mm"), arg("object_mm"),
             "Where an object comes to focus, mm: f X/(X - f).");
  module.def("object_distance_mm", &optics::object_distance_mm, arg("focal_mm"), arg("image_mm"),
             "The object in focus on a sensor at this distance, mm; infinite at the focal length.");
  module.def(
      "extension_mm", &optics::extension_mm, arg("focal_mm"), arg("object_mm"),
      "How much farther than for infinity the lens stands from the sensor, mm: f^2/(X - f).");
  module.def("object_at_extension_mm", &optics::object_at_extension_mm, arg("focal_mm"),
             arg("extension_mm"),
             "The object that a lens so far out is focused on, mm; infinite at 0.");
  module.def("magnification", &optics::magnification, arg("focal_mm"), arg("object_mm"),
             "Size on the sensor over size of the object: f/(X - f).");
  module.def(
      "working_f_number",
      [](double focal_mm, double f_number, double object_mm) {
        return optics::working_f_number({focal_mm, f_number, kAnyCircle_mm}, object_mm);
      },
      arg("focal_mm"), arg("f_number"), arg("object_mm"),
      "f-number of the light that meets the sensor: N (1 + magnification).");
  module.def(
      "depth_of_field",
      [](double focal_mm, double f_number, double circle_mm, double object_mm) {
        const auto depth = optics::depth_of_field({focal_mm, f_number, circle_mm}, object_mm);
        return py::make_tuple(depth.near_mm, depth.far_mm);
      },
      arg("focal_mm"), arg("f_number"), arg("circle_mm"), arg("object_mm"),
      "Nearest and farthest distance, mm, at which an object looks sharp (eq. 3-3).");
  module.def(
      "hyperfocal_mm",
      [](double focal_mm, double f_number, double circle_mm) {
        return optics::hyperfocal_mm({focal_mm, f_number, circle_mm});
      },
      arg("focal_mm"), arg("f_number"), arg("circle_mm"),
      "From here on the far limit is infinite, mm: f^2/(C N).");
  module.def(
      "depth_of_focus_mm",
      [](double focal_mm, double f_number, double circle_mm, double object_mm) {
        return optics::depth_of_focus_mm({focal_mm, f_number, circle_mm}, object_mm);
      },
      arg("focal_mm"), arg("f_number"), arg("circle_mm"), arg("object_mm"),
      "How far the sensor may be moved, between both ends, mm.");
  module.def("disc_of_confusion_mm", &optics::disc_of_confusion_mm, arg("focal_mm"),
             arg("f_number"), arg("image_mm"), arg("sensor_mm"),
             "Diameter of the disc that a point becomes beside its image, mm.");
  module.def("airy_radius_um", &optics::airy_radius_um, arg("focal_mm"), arg("aperture_mm"),
             arg("wavelength_nm"), "Radius of the Airy disc, um: 1.22 lambda f/d.");
  module.def("cutoff_cycles_per_mm", &optics::cutoff_cycles_per_mm, arg("working_f_number"),
             arg("wavelength_nm"),
             "Frequency on the sensor from which on no contrast is left, cycles/mm.");
  module.def("diffraction_mtf", &optics::diffraction_mtf, arg("cutoff_part"),
             "MTF of a perfect lens in focus, 0 to 1, at a part of the cutoff.");
  module.def("defocused_otf", &optics::defocused_otf, arg("cutoff_part"), arg("waves"),
             "Transfer function of a perfect lens out of focus by so many waves (Hopkins 1955).");
}

}  // namespace fathom::python
