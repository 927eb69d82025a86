// SPDX-License-Identifier: Apache-2.0
// Maps of depth as arrays and numbers, and back.
#pragma once

#include <pybind11/pybind11.h>

#include "mapping/report.hpp"

namespace fathom::python {

namespace py = pybind11;

/// Arrays that own what the result had (depth, sigma, confidence: float32; index: uint16; classes:
/// uint8; sharp: grey or colours; curves), and what is known beside them.
py::dict dict_of(mapping::DepthResult result, const mapping::ReportFacts& facts);

/// What dict_of() was made of, from copies of its arrays. Throws Error(bad_argument), naming the
/// array, for one of another size.
mapping::DepthResult depth_result_of(const py::dict& values);
mapping::ReportFacts facts_of(const py::dict& values);

}  // namespace fathom::python
