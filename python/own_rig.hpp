// SPDX-License-Identifier: Apache-2.0
// Objects of Python as camera and lens: whatever can take a picture and move.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "engine/travel.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::python {

/// What Python says of its stage and camera.
struct OwnRig {
  pybind11::object snap;      ///< () -> array; its exposure begins after it is called.
  pybind11::object move_to;   ///< (position): returns when the stage stands still.
  pybind11::object position;  ///< () -> where it stands; or None.
  double start = 0;           ///< Where it stands, if position is None.
  double exposure_ms = 0;     ///< Of the camera; 0 where nobody knows.
  int stale = 0;              ///< Pictures that the camera may still have from before a move.
  LensInfo travel;
};

/// Takes one picture, to know their size. Throws what Python throws, Error(bad_argument) for a
/// picture that is none.
Hardware own_hardware(OwnRig rig);

}  // namespace fathom::python
