// SPDX-License-Identifier: Apache-2.0
// fathom.optics: the functions of engine/optics.hpp by their own names.
#pragma once

#include <pybind11/pybind11.h>

namespace fathom::python {

void bind_optics(pybind11::module_& module);

}  // namespace fathom::python
