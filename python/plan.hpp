// SPDX-License-Identifier: Apache-2.0
// fathom.Plan: windows scored as pictures come, without waiting for each.
#pragma once

#include <pybind11/pybind11.h>

namespace fathom::python {

void bind_plan(pybind11::module_& module);

}  // namespace fathom::python
