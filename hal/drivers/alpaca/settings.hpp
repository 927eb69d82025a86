// SPDX-License-Identifier: Apache-2.0
// What a rig text or a rig file says of an Alpaca rig.
#pragma once

#include <optional>
#include <string>

#include "hal/drivers/alpaca/connection.hpp"
#include "hal/lens_traits.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::alpaca {

/// What is left out is not changed.
struct CameraKeys {
  std::optional<double> exposure_ms;
  std::optional<int> binning;
  std::optional<int> x, y, width, height;  ///< Of the binned picture.
  std::optional<double> gain;
};

struct FocuserKeys {
  std::optional<double> lowest, highest;
  std::optional<double> start;   ///< Of a relative focuser: where it stands when it is opened,
  std::optional<double> travel;  ///< and how far out it can go.
  std::int64_t stall_ns = 0;     ///< A move without progress for so long has failed.
  LensTraits traits;
};

struct Settings {
  Address server;
  std::string camera;   ///< A name or a number; empty: the only one.
  std::string focuser;  ///< Likewise.
  std::int64_t timeout_ns = 0;
  CameraKeys camera_keys;
  FocuserKeys focuser_keys;

  /// Throws Error(bad_argument).
  static Settings read(const RigSettings& settings);
};

}  // namespace fathom::alpaca
