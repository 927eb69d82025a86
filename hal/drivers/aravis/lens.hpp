// SPDX-License-Identifier: Apache-2.0
// A liquid lens or a motorised focus that a camera offers as one of its features.
#pragma once

#include <memory>

#include "hal/drivers/aravis/device.hpp"
#include "hal/drivers/aravis/settings.hpp"
#include "hal/lens.hpp"
#include "hal/stop.hpp"

namespace fathom::aravis {

/// Throws Error(unsupported) for a feature that is no number, cannot be set, or leaves no travel.
std::unique_ptr<Lens> open_lens(const std::shared_ptr<Device>& device, const LensKeys& keys,
                                const StopRequests& stop_requests);

/// Features of this camera that look like a focus, by their names.
std::string focus_features(const Device& device);

}  // namespace fathom::aravis
