// SPDX-License-Identifier: Apache-2.0
// fathom range --all: every surface in the picture with its distance.
#pragma once

#include <optional>
#include <string>

#include "engine/selection.hpp"
#include "focus/blur.hpp"
#include "tools/fathom/depth/taking.hpp"

namespace fathom::cli {

struct RangeAllRequest {
  TakingRequest taking;
  std::string calibration;  ///< Its path, or empty: positions are told then.
  bool extrapolate = false;
  std::optional<BlurModel> blur = {};  ///< Of the lens, where somebody says it.
  std::string backend = {};
  DeviceOptions device = {};
  std::string output = {};  ///< A file for the run, or empty.
  std::string csv = {};     ///< A file for them, or empty.
  bool json = false;
};

/// Measures, prints and writes them, and keeps the run. Returns the exit status: no surface is no
/// focus, and a stop is an error, though what was seen until then is told. Throws as Taking,
/// Calibration::parse and write_file.
int range_all(const RangeAllRequest& request);

}  // namespace fathom::cli
