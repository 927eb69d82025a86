// SPDX-License-Identifier: Apache-2.0
// The keys of a device on a serial port in a rig file.
#pragma once

#include <optional>
#include <string>

#include "hal/drivers/serial/profile.hpp"
#include "hal/lens_traits.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::serial {

struct Settings {
  std::string port;
  std::string profile_name;
  Profile profile;
  std::optional<double> lowest, highest;  ///< Absent: the device is asked.
  double home_position = 0;               ///< Of a device that forgets: where its home is.
  double stall_s = 10;                    ///< Without progress a move has failed.
  double home_s = 120;                    ///< For finding home.
  std::string state;                      ///< Where the position of one that forgets is kept.
  LensTraits traits;

  /// Throws Error(bad_argument), Error(bad_data), Error(io).
  static Settings read(const RigSettings& settings);
};

}  // namespace fathom::serial
