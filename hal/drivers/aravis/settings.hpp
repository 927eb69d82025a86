// SPDX-License-Identifier: Apache-2.0
// What a rig text or a rig file says of a machine-vision camera.
#pragma once

#include <optional>
#include <string>

#include "hal/drivers/aravis/pixels.hpp"
#include "hal/lens_traits.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::aravis {

enum class Trigger {
  automatic,  ///< By software where the camera can be, else none.
  none,       ///< Frames come by themselves.
  software,
};

/// What is left out is not changed.
struct CameraKeys {
  std::string format;  ///< A name of the standard; empty: as it stands, or the best that is read.
  MosaicUse bayer = MosaicUse::luma;
  std::optional<int> x, y, width, height;  ///< Of the sensor, after binning.
  std::optional<int> binning;
  double exposure_ms = 0;
  std::optional<double> gain;
  double fps = 0;
  Trigger trigger = Trigger::automatic;
  bool stamps_start = false;  ///< The camera stamps the begin of an exposure, not its end.
  double delay_frames = 1;    ///< A frame waits so long in a camera whose clock nobody can read.
  int buffers = 8;
  int packet_bytes = 0;
  bool leave_automatics = false;
};

struct LensKeys {
  std::string node;  ///< Empty: no lens.
  std::optional<double> lowest, highest, step;
  LensTraits traits;
};

struct Settings {
  std::string camera;
  CameraKeys camera_keys;
  LensKeys lens_keys;

  /// Throws Error(bad_argument).
  static Settings read(const RigSettings& settings);
};

}  // namespace fathom::aravis
