// SPDX-License-Identifier: Apache-2.0
// fathom.devices: what can compute here.
#pragma once

#include <pybind11/pybind11.h>

namespace fathom::python {

void bind_devices(pybind11::module_& module);

}  // namespace fathom::python
