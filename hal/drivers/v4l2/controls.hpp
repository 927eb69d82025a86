// SPDX-License-Identifier: Apache-2.0
// The controls of a device (exposure, gain, focus), and how they are found again as they were.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/drivers/v4l2/device.hpp"

namespace fathom::v4l2 {

/// What a driver says of one control.
struct Control {
  std::uint32_t id = 0;
  std::string name;  ///< The driver's own word, for messages.
  std::int32_t lowest = 0;
  std::int32_t highest = 0;
  std::int32_t step = 1;
  bool is_inactive = false;  ///< Without effect as other controls stand.

  /// The nearest value that it can take, the lower of two; also of what no integer holds.
  std::int32_t nearest(double value) const;
};

/// Nothing for a control that the device has not, or that cannot be set.
std::optional<Control> find_control(const Device& device, std::uint32_t id);

/// `when`: the end of the message's "cannot read ...". Throws as Device::fail.
std::int32_t read_control(const Device& device, const Control& control, std::string_view when = "");

/// Sets controls and, when it is destroyed, puts back what it found, last first: a manual exposure
/// can only be written while the automatic is still off.
class ControlGuard {
 public:
  explicit ControlGuard(std::shared_ptr<Device> device) : device_(std::move(device)) {}
  ControlGuard(const ControlGuard&) = delete;
  ControlGuard& operator=(const ControlGuard&) = delete;
  ~ControlGuard();

  const Device& device() const { return *device_; }
  bool has_changed_anything() const { return !found_.empty(); }

  /// Sets a control and reads it back: the value that it has now. Throws as Device::fail.
  std::int32_t set(const Control& control, std::int32_t value);

 private:
  struct Found {
    std::uint32_t id;
    std::int32_t value;
  };
  void remember(const Control& control);

  std::shared_ptr<Device> device_;
  std::vector<Found> found_;
};

/// Whatever changes a picture by itself, except focus, is switched off. Throws Error(io) naming the
/// control that stays on.
void switch_off_automatics(ControlGuard& guard);

/// The same for focus, which belongs to the lens as well.
void switch_off_automatic_focus(ControlGuard& guard);

}  // namespace fathom::v4l2
