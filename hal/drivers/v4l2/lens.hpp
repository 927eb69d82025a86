// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hal/drivers/v4l2/device.hpp"
#include "hal/lens_traits.hpp"

namespace fathom::v4l2 {

/// What a rig file says of a lens.
struct LensKeys {
  LensTraits traits;
  std::optional<int> lowest;  ///< Soft limits within the driver's own.
  std::optional<int> highest;
  double units_per_s = 0;  ///< How fast the motor is; 0: settle_ms includes the way.

  /// Throws Error(bad_argument).
  static LensKeys read(const RigSettings& settings);
};

/// Opens the motorised focus of a device or sub-device; null for one without. Throws as
/// RigDriver::open.
std::unique_ptr<Lens> open_lens(const std::shared_ptr<Device>& device, const LensKeys& keys,
                                const StopRequests& stop_requests);

}  // namespace fathom::v4l2
