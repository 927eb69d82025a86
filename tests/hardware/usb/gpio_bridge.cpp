// SPDX-License-Identifier: Apache-2.0
#include "gpio_bridge.hpp"

namespace fathom::usb {

namespace {

// Silicon Labs AN571 and AN978; a vendor request whose value says what it is about.
enum Register {
  read_latch = 0x00c2,
  part_number = 0x370b,
  port_configuration = 0x370c,
  write_latch = 0x37e1
};
constexpr int vendor_specific = 0xff, cp2104 = 4;
constexpr int line_count = 4;

Bytes configuration() {
  Bytes interfaces{9, 4, 0, 0, 2, 0xff, 0, 0, 0};
  append(interfaces, {7, 5, 0x81, 2, 64, 0, 0});
  append(interfaces, {7, 5, 0x02, 2, 64, 0, 0});
  Bytes all{9, 2};
  append_number(all, static_cast<int>(9 + interfaces.size()), 2);
  append(all, {1, 1, 0, 0x80, 50});
  append(all, interfaces);
  return all;
}

// Which pins are push-pull, and which are high after a reset: pins 0 to 3 are bits 8 to 11.
Bytes pin_configuration() {
  constexpr int push_pull = 0b1011 << 8, high = 0b0100 << 8;
  Bytes bytes;
  append_number(bytes, push_pull, 2);
  append_number(bytes, 0, 2);
  append_number(bytes, high, 2);
  append_number(bytes, 0, 4);
  append_number(bytes, high, 2);
  append_number(bytes, 0, 1);  // No pin has another function.
  return bytes;
}

}  // namespace

GpioBridge::GpioBridge(Stepper& stepper)
    : Device({.vendor = 0x10c4,
              .product = 0xea60,
              .maker = "Silicon Labs",
              .name = "CP2104 USB to UART Bridge Controller",
              .serial = "0001",
              .configuration = configuration()}),
      stepper_(stepper) {}

std::optional<Bytes> GpioBridge::read_request(const Setup& setup) {
  // Of the serial port nothing is wanted; what it answers has no meaning but to be there.
  if (setup.request != vendor_specific) return Bytes(setup.length);
  switch (setup.value) {
    case part_number:
      return Bytes{cp2104};
    case port_configuration:
      return pin_configuration();
    case read_latch: {
      int pins = 0;
      for (int line = 0; line < line_count; ++line) {
        pins |= stepper_.get(static_cast<Stepper::Line>(line)) << line;
      }
      return Bytes{static_cast<std::uint8_t>(pins)};
    }
    default:
      return std::nullopt;
  }
}

bool GpioBridge::write_request(const Setup& setup, const Bytes&) {
  if (setup.request != vendor_specific) return true;
  if (setup.value != write_latch) return false;
  const int mask = setup.index & 0xff, pins = setup.index >> 8;
  const std::int64_t time_ns = now_ns();
  for (int line = 0; line < line_count; ++line) {
    if ((mask >> line & 1) != 0) {
      stepper_.set(static_cast<Stepper::Line>(line), (pins >> line & 1) != 0, time_ns);
    }
  }
  return true;
}

}  // namespace fathom::usb
