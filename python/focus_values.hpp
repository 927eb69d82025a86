// SPDX-License-Identifier: Apache-2.0
// What a search came to, as Python's dictionaries; the package makes its result objects of them.
#pragma once

#include <pybind11/pybind11.h>

#include <span>
#include <vector>

#include "focus/focus.hpp"
#include "session/run.hpp"

namespace fathom::python {

namespace py = pybind11;

py::dict dict_of(const Peak& peak);
/// Verdict, reason, peak, lobes, curve.
py::dict dict_of(const Focus& focus);
/// positions, scores: arrays in order of position.
py::dict curve_of(const std::vector<Evaluation>& evaluations);
py::dict dict_of(const Journey& journey);

}  // namespace fathom::python
