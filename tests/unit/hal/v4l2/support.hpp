// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "fake_system.hpp"
#include "hal/drivers/v4l2/driver.hpp"

namespace fathom::test {

/// Opens /dev/video0 of a made-up system with more keys; every key must be known.
inline Hardware open_v4l2(FakeSystem& system, std::map<std::string, std::string> keys = {},
                          const OpenOptions& options = {}) {
  keys.emplace("device", "/dev/video0");
  const RigSettings settings("v4l2", std::move(keys));
  Hardware hardware = v4l2::open(system, settings, options);
  settings.require_all_used();
  return hardware;
}

}  // namespace fathom::test
