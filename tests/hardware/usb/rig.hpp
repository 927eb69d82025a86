// SPDX-License-Identifier: Apache-2.0
// The devices of one simulated rig, and the commands that they obey while running.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "camera.hpp"
#include "device_thread.hpp"
#include "gpio_bridge.hpp"
#include "stepper.hpp"

namespace fathom::usb {

struct RigOptions {
  std::optional<CameraOptions> camera;
  std::optional<StepperOptions> stepper;
  /// The motor moves the camera's lens: carriage step 0 is focus 0 (one step, one unit).
  bool stepper_moves_lens = false;
};

class Rig {
 public:
  /// Plugs the devices in. Throws std::runtime_error.
  explicit Rig(const RigOptions& options);
  /// Answers one command: "ok", what was asked for, or "error: ...".
  std::string obey(const std::string& line);

  static const char* command_help();

 private:
  std::string obey_camera(const std::string& verb, int first, int second);
  std::string obey_bridge(const std::string& verb, int first);
  std::string status();

  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<GpioBridge> bridge_;
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<DeviceThread> bridge_thread_, camera_thread_;
};

}  // namespace fathom::usb
