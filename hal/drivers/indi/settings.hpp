// SPDX-License-Identifier: Apache-2.0
// What a rig text can ask of an INDI rig.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/lens_traits.hpp"
#include "hal/rig_driver.hpp"
#include "hal/socket.hpp"

namespace fathom::indi {

/// INDI's own.
inline constexpr const char* kUsualPort = "7624";

struct CameraWishes {
  std::optional<double> exposure_ms;
  double longest_exposure_ms = 0;  ///< Longer ones are not taken, whatever the camera can do.
  std::optional<int> x, y, width, height;  ///< CCD_FRAME: pixels of the chip, before binning.
  std::optional<int> binning;
  std::optional<double> gain;
};

struct FocuserWishes {
  std::optional<double> start;   ///< Relative focusers: where it stands when it is opened,
  std::optional<double> travel;  ///< how far it can go outward from its inner stop,
  bool home = false;             ///< and whether to go there first.
  std::int64_t stall_ns = 0;     ///< A move without progress for so long has failed.
  LensTraits traits;
};

struct IndiSettings {
  std::string where;  ///< How messages name the place of the settings.
  Address server;
  std::string camera;   ///< Empty: the only one.
  std::string focuser;  ///< Likewise.
  std::optional<double> polling_ms;
  std::int64_t timeout_ns = 0;
  CameraWishes camera_wishes;
  FocuserWishes focuser_wishes;

  /// Throws Error(bad_argument).
  static IndiSettings read(const RigSettings& settings);
};

}  // namespace fathom::indi
