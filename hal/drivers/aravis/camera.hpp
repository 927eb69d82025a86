// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hal/camera.hpp"
#include "hal/drivers/aravis/device.hpp"
#include "hal/drivers/aravis/settings.hpp"
#include "hal/stop.hpp"

namespace fathom::aravis {

/// Puts the settings in force and starts the stream. Throws as RigDriver::open.
std::unique_ptr<Camera> open_camera(const std::shared_ptr<Device>& device, const CameraKeys& keys,
                                    const StopRequests& stop_requests);

}  // namespace fathom::aravis
