// SPDX-License-Identifier: Apache-2.0
#include "python/given.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "python/errors.hpp"

namespace fathom::python {
namespace {

[[noreturn]] void refuse_kind(py::handle value, const char* name, const char* kind) {
  constexpr std::size_t kLongest = 60;
  std::string shown =
      py::str(py::module_::import("builtins").attr("ascii")(value)).cast<std::string>();
  if (shown.size() > kLongest) shown = "a " + std::string(Py_TYPE(value.ptr())->tp_name);
  refuse(fmt::format("{} is {}; it is {}", name, shown, kind));
}

template <class Value>
std::optional<Value> wished(Value (*given)(py::handle, const char*), py::handle value,
                            const char* name) {
  if (value.is_none()) return std::nullopt;
  return given(value, name);
}

}  // namespace

std::string given_text(py::handle value, const char* name) {
  Py_ssize_t bytes = 0;
  const char* const text =
      py::isinstance<py::str>(value) ? PyUnicode_AsUTF8AndSize(value.ptr(), &bytes) : nullptr;
  if (text == nullptr) {
    PyErr_Clear();  // half of a pair of surrogates is no text either
    refuse_kind(value, name, "a text");
  }
  return {text, static_cast<std::size_t>(bytes)};
}

int given_count(py::handle value, const char* name) {
  const auto number = py::reinterpret_steal<py::object>(
      py::isinstance<py::bool_>(value) ? nullptr : PyNumber_Index(value.ptr()));
  if (!number) {
    PyErr_Clear();
    refuse_kind(value, name, "an integer");
  }
  int is_over = 0;
  const long count = PyLong_AsLongAndOverflow(number.ptr(), &is_over);
  if (is_over != 0 || count < std::numeric_limits<int>::min() ||
      count > std::numeric_limits<int>::max())
    refuse_kind(value, name, "an integer that is not so large");
  return static_cast<int>(count);
}

double given_number(py::handle value, const char* name) {
  const bool is_flag = py::isinstance<py::bool_>(value);
  const double number = is_flag ? -1 : PyFloat_AsDouble(value.ptr());
  if (is_flag || (number == -1 && PyErr_Occurred() != nullptr)) {
    PyErr_Clear();
    refuse_kind(value, name, "a number");
  }
  return number;
}

std::size_t given_choice(py::handle value, const char* name,
                         const std::vector<std::string>& choices) {
  const std::string text = given_text(value, name);
  const auto found = std::ranges::find(choices, text);
  if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
  std::string all;
  for (std::size_t i = 0; i < choices.size(); ++i)
    all += (i == 0 ? "'" : i + 1 == choices.size() ? " or '" : ", '") + choices[i] + "'";
  refuse(fmt::format("{} is '{}'; it is {}", name, text, all));
}

std::optional<std::string> wished_text(py::handle value, const char* name) {
  return wished(given_text, value, name);
}

std::optional<int> wished_count(py::handle value, const char* name) {
  return wished(given_count, value, name);
}

std::optional<double> wished_number(py::handle value, const char* name) {
  return wished(given_number, value, name);
}

std::optional<std::pair<int, int>> wished_corner(py::handle value, const char* name) {
  constexpr const char* kKind = "a corner (x, y) of two integers";
  if (value.is_none()) return std::nullopt;
  if (PySequence_Check(value.ptr()) == 0 || PySequence_Size(value.ptr()) != 2) {
    PyErr_Clear();
    refuse_kind(value, name, kKind);
  }
  const auto corner = py::reinterpret_borrow<py::sequence>(value);
  const py::object x = corner[0], y = corner[1];
  if (PyIndex_Check(x.ptr()) == 0 || PyIndex_Check(y.ptr()) == 0) refuse_kind(value, name, kKind);
  return std::pair(given_count(x, name), given_count(y, name));
}

}  // namespace fathom::python
