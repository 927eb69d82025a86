// SPDX-License-Identifier: Apache-2.0
// fathom.Calibration: the library's own, with dictionaries for its small structures.
#pragma once

#include <pybind11/pybind11.h>

namespace fathom::python {

void bind_calibrating(pybind11::module_& module);

}  // namespace fathom::python
