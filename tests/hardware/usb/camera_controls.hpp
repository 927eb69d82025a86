// SPDX-License-Identifier: Apache-2.0
// The camera's controls as UVC has them: numbers with limits, each in a unit of the camera.
#pragma once

#include <optional>
#include <vector>

#include "bytes.hpp"
#include "link.hpp"

namespace fathom::usb {

struct Control {
  int unit, selector, size;
  int least, most, step, initial;
  int value;
};

/// Entities of the camera; the streaming interface is number 1.
constexpr int camera_terminal = 1, processing_unit = 2, output_terminal = 3;

/// UVC's reasons for a refused request.
enum class Refusal : std::uint8_t {
  none = 0,
  wrong_state = 2,
  out_of_range = 4,
  unknown_control = 6
};

struct ControlOptions {
  int focus_least = 0, focus_most = 1000, focus_step = 1, focus_initial = 0;
  /// How exposure, focus and white balance are at the start, as in any webcam.
  bool automatic = true;
  bool tells_changes = true;  ///< Else the driver reads a value once, and believes it for ever.
};

class CameraControls {
 public:
  explicit CameraControls(const ControlOptions& options);

  Control focus, focus_auto, exposure_mode, exposure_100us, brightness, gain, white_balance_k,
      white_balance_auto;

  bool automatic_exposure() const { return exposure_mode.value != 1; }

  std::optional<Bytes> read(const Setup& setup);
  /// The control that was written, or nothing.
  const Control* write(const Setup& setup, const Bytes& data);

 private:
  Control* find(const Setup& setup);
  bool ruled_by_automatic(const Control& control) const;
  int abilities(const Control& control) const;

  bool tells_changes_;
  Refusal refusal_ = Refusal::none;
};

}  // namespace fathom::usb
