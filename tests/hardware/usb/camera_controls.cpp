// SPDX-License-Identifier: Apache-2.0
#include "camera_controls.hpp"

namespace fathom::usb {

namespace {

enum Request {
  set_current = 0x01,
  get_current = 0x81,
  get_least = 0x82,
  get_most = 0x83,
  get_step = 0x84,
  get_length = 0x85,
  get_abilities = 0x86,
  get_initial = 0x87,
};

constexpr int aperture_priority = 8;  // UVC's word for: the camera chooses the exposure.
constexpr int exposure_modes = 1 | aperture_priority;

Bytes bytes_of(int value, int size) {
  Bytes bytes;
  append_number(bytes, value, size);
  return bytes;
}

}  // namespace

CameraControls::CameraControls(const ControlOptions& options)
    : focus{camera_terminal,
            6,
            2,
            options.focus_least,
            options.focus_most,
            options.focus_step,
            options.focus_initial,
            options.focus_initial},
      focus_auto{camera_terminal, 8, 1, 0, 1, 1, 1, options.automatic},
      exposure_mode{camera_terminal,
                    2,
                    1,
                    1,
                    aperture_priority,
                    exposure_modes,
                    aperture_priority,
                    options.automatic ? aperture_priority : 1},
      exposure_100us{camera_terminal, 4, 4, 1, 5000, 1, 100, 100},
      brightness{processing_unit, 2, 2, -64, 64, 1, 0, 0},
      gain{processing_unit, 4, 2, 4, 128, 1, 16, 16},
      white_balance_k{processing_unit, 10, 2, 2800, 6500, 10, 4600, 4600},
      white_balance_auto{processing_unit, 11, 1, 0, 1, 1, 1, options.automatic},
      tells_changes_(options.tells_changes) {}

Control* CameraControls::find(const Setup& setup) {
  for (Control* control : {&focus, &focus_auto, &exposure_mode, &exposure_100us, &brightness, &gain,
                           &white_balance_k, &white_balance_auto}) {
    if (setup.index == control->unit << 8 && setup.value == control->selector << 8) return control;
  }
  return nullptr;
}

bool CameraControls::ruled_by_automatic(const Control& control) const {
  if (&control == &focus) return focus_auto.value != 0;
  if (&control == &exposure_100us) return automatic_exposure();
  return &control == &white_balance_k && white_balance_auto.value != 0;
}

int CameraControls::abilities(const Control& control) const {
  constexpr int readable = 1, writable = 2, off_while_automatic = 4, changes_by_itself = 8;
  const bool changes =
      &control == &focus || &control == &exposure_100us || &control == &white_balance_k;
  return readable | writable | (ruled_by_automatic(control) ? off_while_automatic : 0) |
         (changes && tells_changes_ ? changes_by_itself : 0);
}

std::optional<Bytes> CameraControls::read(const Setup& setup) {
  // The interface itself: why the last request was refused.
  if (setup.index == 0 && setup.value == 2 << 8) return Bytes{static_cast<std::uint8_t>(refusal_)};
  const Control* control = find(setup);
  refusal_ = control ? Refusal::none : Refusal::unknown_control;
  if (!control) return std::nullopt;
  switch (setup.request) {
    case get_current:
      return bytes_of(control->value, control->size);
    case get_least:
      return bytes_of(control->least, control->size);
    case get_most:
      return bytes_of(control->most, control->size);
    case get_step:
      return bytes_of(control->step, control->size);
    case get_initial:
      return bytes_of(control->initial, control->size);
    case get_length:
      return bytes_of(control->size, 2);
    case get_abilities:
      return Bytes{static_cast<std::uint8_t>(abilities(*control))};
    default:
      return std::nullopt;
  }
}

const Control* CameraControls::write(const Setup& setup, const Bytes& data) {
  Control* control = find(setup);
  refusal_ = control && setup.request == set_current ? Refusal::none : Refusal::unknown_control;
  if (refusal_ != Refusal::none) return nullptr;
  const std::uint32_t raw = number(data, control->size);
  const int value = control->size == 2 && control->least < 0 ? static_cast<std::int16_t>(raw)
                                                             : static_cast<int>(raw);
  if (value < control->least || value > control->most) refusal_ = Refusal::out_of_range;
  if (ruled_by_automatic(*control)) refusal_ = Refusal::wrong_state;
  if (refusal_ != Refusal::none) return nullptr;
  control->value = value;
  return control;
}

}  // namespace fathom::usb
