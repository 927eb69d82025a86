// SPDX-License-Identifier: Apache-2.0
// The extension module fathom._fathom: what the package fathom is made of.
#include "python/calibrating.hpp"
#include "python/depth.hpp"
#include "python/devices.hpp"
#include "python/errors.hpp"
#include "python/focusing.hpp"
#include "python/optics.hpp"
#include "python/plan.hpp"
#include "python/rig.hpp"
#include "python/scoring.hpp"

PYBIND11_MODULE(_fathom, module) {
  module.doc() = "The engine and the instrument, as the package fathom uses them; no interface.";
  module.attr("version") = FATHOM_VERSION;
  fathom::python::bind_errors(module);
  fathom::python::bind_scoring(module);
  fathom::python::bind_plan(module);
  fathom::python::bind_focusing(module);
  fathom::python::bind_calibrating(module);
  fathom::python::bind_optics(module);
  fathom::python::bind_rig(module);
  fathom::python::bind_devices(module);
  fathom::python::bind_depth(module);
}
