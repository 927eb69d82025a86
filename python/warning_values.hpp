// SPDX-License-Identifier: Apache-2.0
// Warnings as a name, its values and its words.
#pragma once

#include <pybind11/pybind11.h>

#include "session/warning.hpp"
#include "words/calibration_words.hpp"

namespace fathom::python {

/// {"kind": "saturation", "part": 0.1, ..., "text": "..."}
pybind11::dict dict_of(const Warning& warning);
/// {"kind": "calibration-poor", "text": "..."}
pybind11::dict dict_of(const CalibrationDoubt& doubt);

}  // namespace fathom::python
