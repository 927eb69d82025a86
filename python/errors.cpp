// SPDX-License-Identifier: Apache-2.0
#include "python/errors.hpp"

#include "engine/error.hpp"

namespace fathom::python {
namespace {

void set_python_error(const Error& error) {
  const py::object exception =
      py::module_::import("fathom._errors").attr("error_of")(to_string(error.code()), error.what());
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(exception.ptr())), exception.ptr());
}

}  // namespace

void bind_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const Error& error) {
      set_python_error(error);
    }
  });
}

void refuse(std::string_view why) { throw Error(ErrorCode::bad_argument, why); }

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace fathom::python
