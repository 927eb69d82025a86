// SPDX-License-Identifier: Apache-2.0
// A CP2104: a USB serial converter whose four spare pins the stock driver cp210x offers as a GPIO
// chip. The stepper motor is behind them. Pins 0 (STEP), 1 (DIR) and 3 (ENABLE) are push-pull
// outputs, pin 2 (HOME) is an open-drain pin left high, which that driver takes for an input.
#pragma once

#include "device.hpp"
#include "stepper.hpp"

namespace fathom::usb {

class GpioBridge : public Device {
 public:
  explicit GpioBridge(Stepper& stepper);

 protected:
  std::optional<Bytes> read_request(const Setup& setup) override;
  bool write_request(const Setup& setup, const Bytes& data) override;

 private:
  Stepper& stepper_;
};

}  // namespace fathom::usb
