# SPDX-License-Identifier: Apache-2.0
# Whether the Python module is built, and for which Python: the system's, whatever the PATH says.
#
# Built where pybind11 is there, unless somebody says otherwise. Python itself is not sanitized: tests/python
# loads the sanitizer of addresses before Python. That of threads knows no Python, so there it is not built.
set(FATHOM_PYTHON_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The Python that the module is for")
set(Python_EXECUTABLE ${FATHOM_PYTHON_EXECUTABLE})
find_package(Python 3.11 QUIET COMPONENTS Interpreter Development.Module)
set(FATHOM_PYTHON_DEFAULT OFF)
if(Python_FOUND)
  find_package(pybind11 CONFIG QUIET)
  if(pybind11_FOUND AND NOT FATHOM_SANITIZE MATCHES "thread|fuzzer")
    set(FATHOM_PYTHON_DEFAULT ON)
  endif()
endif()
option(FATHOM_PYTHON "Build the Python module (needs pybind11)" ${FATHOM_PYTHON_DEFAULT})
if(FATHOM_PYTHON AND NOT pybind11_FOUND)
  message(FATAL_ERROR "FATHOM_PYTHON needs Python 3.11 with its headers and pybind11 "
    "(Debian: python3-dev pybind11-dev), or FATHOM_PYTHON_EXECUTABLE")
endif()
