// SPDX-License-Identifier: Apache-2.0
// Colours in numpy's arrays.
#pragma once

#include <pybind11/numpy.h>

#include <string>

#include "mapping/depth_maker.hpp"

namespace fathom::python {

namespace py = pybind11;

/// Whether an array has the shape of one picture of colours: (rows, columns, 3 or 4).
bool is_coloured(py::handle image);

/// Copies red, green and blue of uint8 or uint16, and their luma as the grey; a fourth number, alpha,
/// does not count. Throws Error(bad_argument), naming the argument, for other numbers.
mapping::ColourPicture colour_picture(const py::array& image, const std::string& argument);

}  // namespace fathom::python
