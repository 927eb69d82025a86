// SPDX-License-Identifier: Apache-2.0
// Rigs for Python: by a text, of a stack, of Python's own camera and stage.
#pragma once

#include <pybind11/pybind11.h>

namespace fathom::python {

void bind_rig(pybind11::module_& module);

}  // namespace fathom::python
