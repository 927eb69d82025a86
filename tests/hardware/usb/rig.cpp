// SPDX-License-Identifier: Apache-2.0
#include "rig.hpp"

#include <sstream>
#include <stdexcept>

namespace fathom::usb {

namespace {

// What any device does. False: it is something else.
bool obey_device(Device& device, const std::string& verb, int count) {
  if (verb == "unplug")
    device.unplug();
  else if (verb == "plug")
    device.plug();
  else if (verb == "refuse")
    device.refuse_requests(count);
  else if (verb == "ignore")
    device.ignore_requests(count);
  else
    return false;
  return true;
}

}  // namespace

const char* Rig::command_help() {
  return "status\n"
         "camera|bridge unplug|plug\n"
         "camera|bridge refuse N    the next N control requests fail (STALL)\n"
         "camera|bridge ignore N    the next N control requests are never answered\n"
         "camera stall|resume       no more data, and again\n"
         "camera drop N             N frames are not sent\n"
         "camera corrupt N          N frames are garbage, with the error bit\n"
         "camera shorten N          N frames are half as long, without the error bit\n"
         "camera clamp LEAST MOST   the lens goes no further, in silence\n"
         "camera jam|unjam          the lens does not move, in silence\n"
         "bridge lose N             the motor loses the next N steps\n";
}

Rig::Rig(const RigOptions& options) {
  if (options.stepper) {
    stepper_ = std::make_unique<Stepper>(*options.stepper);
    bridge_ = std::make_unique<GpioBridge>(*stepper_);
  }
  if (options.camera) {
    LensPosition lens;
    if (options.stepper_moves_lens) {
      if (!stepper_) throw std::runtime_error("no stepper to move the lens");
      lens = [this](std::int64_t time_ns) { return stepper_->carriage_at(time_ns); };
    }
    camera_ = std::make_unique<Camera>(*options.camera, lens);
  }
  if (bridge_) bridge_->plug(), bridge_thread_ = std::make_unique<DeviceThread>(*bridge_);
  if (camera_) camera_->plug(), camera_thread_ = std::make_unique<DeviceThread>(*camera_);
}

std::string Rig::obey(const std::string& line) try {
  std::istringstream words(line);
  std::string whom, verb;
  int first = 1, second = 0;
  words >> whom >> verb;
  if (words >> first) words >> second;
  if (whom == "status") return status();
  if (whom == "camera" && camera_) {
    return camera_thread_->with([&] { return obey_camera(verb, first, second); });
  }
  if (whom == "bridge" && bridge_) {
    return bridge_thread_->with([&] { return obey_bridge(verb, first); });
  }
  return "error: no such device or command: " + line;
} catch (const std::exception& error) {
  return std::string("error: ") + error.what();
}

std::string Rig::obey_camera(const std::string& verb, int first, int second) {
  if (obey_device(*camera_, verb, first)) return "ok";
  if (verb == "stall")
    camera_->stall(true);
  else if (verb == "resume")
    camera_->stall(false);
  else if (verb == "drop")
    camera_->drop_frames(first);
  else if (verb == "corrupt")
    camera_->corrupt_frames(first);
  else if (verb == "shorten")
    camera_->shorten_frames(first);
  else if (verb == "clamp")
    camera_->clamp_focus(first, second);
  else if (verb == "jam")
    camera_->jam_focus(true);
  else if (verb == "unjam")
    camera_->jam_focus(false);
  else
    return "error: a camera does not " + verb;
  return "ok";
}

std::string Rig::obey_bridge(const std::string& verb, int first) {
  if (verb == "unplug") stepper_->reset_lines();
  if (obey_device(*bridge_, verb, first)) return "ok";
  if (verb != "lose") return "error: a bridge does not " + verb;
  stepper_->lose_steps(first);
  return "ok";
}

std::string Rig::status() {
  std::string text;
  if (camera_) text += camera_thread_->with([&] { return camera_->status(); }) + ' ';
  if (stepper_) text += stepper_->status();
  return text.empty() ? "nothing" : text;
}

}  // namespace fathom::usb
