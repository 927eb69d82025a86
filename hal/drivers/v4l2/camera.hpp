// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hal/camera.hpp"
#include "hal/drivers/v4l2/device.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::v4l2 {

/// What a rig file says of a camera; nothing that is left out is changed.
struct CameraKeys {
  std::string format = "auto";  ///< "auto" or the name of a PixelFormat.
  int width_px = 0;             ///< 0: as the device stands.
  int height_px = 0;
  double fps = 0;
  double exposure_ms = 0;
  std::optional<int> gain;
  std::optional<int> input;
  int buffers = 4;
  std::optional<double> delay_frames;
  bool leave_automatics = false;

  /// Throws Error(bad_argument).
  static CameraKeys read(const RigSettings& settings);
};

/// Opens the camera of a device; null for a node that has none (a lens of its own). Throws as
/// RigDriver::open.
std::unique_ptr<Camera> open_camera(const std::shared_ptr<Device>& device, const CameraKeys& keys,
                                    const StopRequests& stop_requests);

}  // namespace fathom::v4l2
