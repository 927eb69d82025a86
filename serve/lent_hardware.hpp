// SPDX-License-Identifier: Apache-2.0
// A rig that is opened once and lent to one Rig after the other, each with a window and a metric of
// its own. Whoever keeps it sees every frame and every move.
#pragma once

#include <functional>
#include <optional>

#include "hal/rig_driver.hpp"

namespace fathom::serve {

/// What the keeper is told, on the thread that uses the rig.
struct HardwareWatch {
  /// A frame came out of the camera. It is only lent.
  std::function<void(const Frame&)> frame;
  /// A move is about to begin.
  std::function<void()> departed;
  /// It has ended, wherever; where the lens stands, if it says so, and since when.
  std::function<void(std::optional<Arrival>)> arrived;
};

class LentHardware {
 public:
  LentHardware(Hardware hardware, HardwareWatch watch)
      : hardware_(std::move(hardware)), watch_(std::move(watch)) {}

  /// Camera, lens and stage that work on these; this must outlive them. The findings go with the
  /// first.
  Hardware lend();

  Camera& camera() { return *hardware_.camera; }
  Lens& lens() { return *hardware_.lens; }
  TargetStage* stage() { return hardware_.stage.get(); }

 private:
  Hardware hardware_;
  HardwareWatch watch_;
};

}  // namespace fathom::serve
