// SPDX-License-Identifier: Apache-2.0
// fathom.depth: maps of stacks in memory, of pictures one by one, and of recordings.
#pragma once

#include <pybind11/pybind11.h>

namespace fathom::python {

void bind_depth(pybind11::module_& module);

}  // namespace fathom::python
