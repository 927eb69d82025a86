// SPDX-License-Identifier: Apache-2.0
// The devices of a backend without connecting to its drivers: what they once answered.
#pragma once

#include <vector>

#include "backend.hpp"
#include "clock.hpp"

namespace fathom {

/// backend.devices(), and kept in the file cache for known_devices().
std::vector<DeviceInfo> list_devices(const Backend& backend, const Clock& clock = machine_clock());

/// What list_devices() last said for the same backend.drivers(), if that is less than kOld_s ago;
/// else list_devices(). on_work may be empty.
std::vector<DeviceInfo> known_devices(const Backend& backend, const OnWork& on_work,
                                      const Clock& clock = machine_clock());

/// After a device was not what the list says: the next known_devices() asks the drivers.
void forget_devices(const Backend& backend);

}  // namespace fathom
