// SPDX-License-Identifier: Apache-2.0
// How the library's errors become Python's exceptions.
#pragma once

#include <pybind11/pybind11.h>

#include <string_view>

namespace fathom::python {

namespace py = pybind11;

/// From now on an Error of the library is an exception of fathom._errors.
void bind_errors(py::module_& module);

/// Throws Error(bad_argument): ValueError there.
[[noreturn]] void refuse(std::string_view why);

/// Throws what Python has to say, such as KeyboardInterrupt, if a signal has come.
void check_signals();

}  // namespace fathom::python
