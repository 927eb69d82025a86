// SPDX-License-Identifier: Apache-2.0
// Simulated USB devices on this machine's real drivers. See README.md beside the guest.
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "commands.hpp"
#include "launch.hpp"
#include "rig.hpp"

namespace {

using namespace fathom::usb;

volatile sig_atomic_t stop_signal = 0;

struct Arguments {
  bool camera = false, stepper = false, motor_lens = false;
  CameraOptions camera_options;
  StepperOptions stepper_options;
  std::vector<std::string> sizes, program;
  std::vector<int> focus_range;
  bool manual = false, cached = false;
  std::string socket = "/tmp/fathom-usb";
};

void add_camera(CLI::App& app, Arguments& arguments) {
  CameraOptions& o = arguments.camera_options;
  app.add_flag("--camera", arguments.camera, "plug in the camera");
  app.add_option("--best", o.best_focus, "focus of the sharpest picture");
  app.add_option("--blur", o.blur_px_per_unit, "blur (sigma, px) per unit from it")
      ->check(CLI::PositiveNumber);
  app.add_option("--sharp", o.sharp_px, "blur (sigma, px) at best focus")
      ->check(CLI::PositiveNumber);
  app.add_option("--scene", o.scene, "texture, bars, star or a PGM file");
  app.add_option("--seed", o.seed, "of texture and noise");
  app.add_option("--noise", o.noise, "standard deviation, 8-bit grey levels")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--fps", o.frames_per_s, "frames per second")->check(CLI::PositiveNumber);
  app.add_option("--latency", o.latency_frames, "frames are so many frames old")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--size", arguments.sizes, "WIDTHxHEIGHT, again for more");
  app.add_option("--focus-range", arguments.focus_range, "LEAST MOST STEP")->expected(3);
  app.add_option("--focus-start", o.motor.start, "where the lens is at first");
  app.add_option("--focus-speed", o.motor.speed_per_s, "units per second")
      ->check(CLI::PositiveNumber);
  app.add_option("--focus-delay", o.motor.delay_ms, "ms from command to movement")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--ringing", o.motor.ringing, "amplitude at arrival, units")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--manual", arguments.manual, "nothing is automatic at first (as a rule, all is)");
  app.add_flag(
      "--cached", arguments.cached,
      "the camera does not say which controls change by themselves: the driver caches them");
}

void add_stepper(CLI::App& app, Arguments& arguments) {
  StepperOptions& o = arguments.stepper_options;
  app.add_flag("--stepper", arguments.stepper, "plug in the GPIO bridge with the motor");
  app.add_flag("--motor-lens", arguments.motor_lens, "the motor moves the camera's lens");
  app.add_option("--motor-start", o.start_steps, "where the motor stands at first");
  app.add_option("--motor-least", o.least_steps, "hard end");
  app.add_option("--motor-most", o.most_steps, "hard end");
  app.add_option("--home-at", o.home_steps, "the switch is pressed from here on down");
  app.add_option("--motor-rate", o.most_steps_per_s, "it loses faster steps")
      ->check(CLI::PositiveNumber);
  app.add_option("--direction-settle", o.settle_us, "us that DIR must be still before STEP")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--motor-backlash", o.backlash_steps, "steps of play")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--log", o.log, "file for every edge");
}

RigOptions rig_options(Arguments& arguments) {
  CameraOptions& camera = arguments.camera_options;
  if (!arguments.sizes.empty()) camera.sizes.clear();
  for (const std::string& text : arguments.sizes) {
    FrameSize size{};
    if (std::sscanf(text.c_str(), "%dx%d", &size.width_px, &size.height_px) != 2 ||
        size.width_px < 16 || size.height_px < 16 || size.width_px % 8 != 0 ||
        size.height_px % 8 != 0) {
      throw std::runtime_error("--size " + text + ": WIDTHxHEIGHT, both multiples of 8");
    }
    camera.sizes.push_back(size);
  }
  ControlOptions& controls = camera.controls;
  if (!arguments.focus_range.empty()) {
    controls.focus_least = arguments.focus_range[0];
    controls.focus_most = arguments.focus_range[1];
    controls.focus_step = arguments.focus_range[2];
  }
  if (controls.focus_least >= controls.focus_most || controls.focus_least < 0 ||
      controls.focus_most > 65535 || controls.focus_step < 1) {
    throw std::runtime_error(
        "--focus-range LEAST MOST STEP: 0 to 65535, rising, a step of 1 or more");
  }
  camera.motor.start =
      std::clamp<double>(camera.motor.start, controls.focus_least, controls.focus_most);
  controls.focus_initial = static_cast<int>(camera.motor.start);
  controls.automatic = !arguments.manual;
  controls.tells_changes = !arguments.cached;
  RigOptions options;
  if (arguments.camera) options.camera = camera;
  if (arguments.stepper) options.stepper = arguments.stepper_options;
  options.stepper_moves_lens = arguments.motor_lens;
  return options;
}

// Obeys commands until a signal, or until the program has ended.
int run(Rig& rig, const Arguments& arguments) {
  CommandSocket commands(arguments.socket);
  wait_for_devices(arguments.camera, arguments.stepper, 30);
  const int process =
      arguments.program.empty() ? 0 : start_program(arguments.program, arguments.socket);
  if (process == 0) {
    fmt::print("camera {} gpio {} socket {}\n", video_device(), gpio_chip(), arguments.socket);
    std::fflush(stdout);
  }
  while (stop_signal == 0) {
    pollfd poll{commands.descriptor(), POLLIN, 0};
    if (::poll(&poll, 1, 20) > 0) {
      commands.serve([&](const std::string& line) { return rig.obey(line); });
    }
    const int status = process == 0 ? -1 : exit_status(process);
    if (status >= 0) return status;
  }
  if (process != 0) ::kill(process, SIGTERM);
  return process == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  Arguments arguments;
  CLI::App app("Simulated USB devices on this machine's real drivers");
  app.footer("Commands for usb_command (one of the devices' socket):\n" +
             std::string(Rig::command_help()));
  add_camera(app, arguments);
  add_stepper(app, arguments);
  app.add_option("--socket", arguments.socket, "where commands are taken");
  app.add_option("program", arguments.program, "run once the devices are there (after --)");
  CLI11_PARSE(app, argc, argv);
  ::signal(SIGINT, [](int) { stop_signal = 1; });
  ::signal(SIGTERM, [](int) { stop_signal = 1; });
  const int status = [&] {
    Rig rig(rig_options(arguments));
    return run(rig, arguments);
  }();
  wait_for_no_devices(3);
  return status;
} catch (const std::exception& error) {
  fmt::print(stderr, "usb_devices: {}\n", error.what());
  return 125;
}
