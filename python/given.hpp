// SPDX-License-Identifier: Apache-2.0
// What a caller gave as an argument, or a refusal that names it.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fathom::python {

namespace py = pybind11;

/// All throw Error(bad_argument) for a value of another kind. `name` is the argument's.
std::string given_text(py::handle value, const char* name);
int given_count(py::handle value, const char* name);
double given_number(py::handle value, const char* name);
/// Which of these texts it is.
std::size_t given_choice(py::handle value, const char* name,
                         const std::vector<std::string>& choices);

/// The same, and nothing for None.
std::optional<std::string> wished_text(py::handle value, const char* name);
std::optional<int> wished_count(py::handle value, const char* name);
std::optional<double> wished_number(py::handle value, const char* name);
/// (x, y), px.
std::optional<std::pair<int, int>> wished_corner(py::handle value, const char* name);

}  // namespace fathom::python
