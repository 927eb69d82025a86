// SPDX-License-Identifier: Apache-2.0
#include "launch.hpp"

#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace fathom::usb {

namespace {

namespace fs = std::filesystem;

// The first device of a class of sysfs that hangs on vhci-hcd and whose number in `index`, where
// it has that file, is 0: a camera has a second video device for metadata.
std::string device_of(const std::string& folder) {
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    const std::string place = fs::canonical(entry.path(), none).string();
    if (place.find("/vhci_hcd.") == std::string::npos) continue;
    std::ifstream file(entry.path() / "index");
    int index = 0;
    if (file && file >> index && index != 0) continue;
    const std::string device = "/dev/" + entry.path().filename().string();
    if (fs::exists(device, none)) return device;
  }
  return {};
}

// Whether it became true in time.
template <typename Condition>
bool wait_until(const Condition& condition, double limit_s) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(limit_s);
  while (!condition()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

}  // namespace

std::string video_device() { return device_of("/sys/class/video4linux"); }
std::string gpio_chip() { return device_of("/sys/bus/gpio/devices"); }

void wait_for_devices(bool video, bool gpio, double limit_s) {
  const bool there = wait_until(
      [&] { return !(video && video_device().empty()) && !(gpio && gpio_chip().empty()); },
      limit_s);
  if (!there) {
    throw std::runtime_error(
        "the kernel has not taken the devices; see dmesg, and whether "
        "uvcvideo and cp210x are loaded");
  }
}

void wait_for_no_devices(double limit_s) {
  wait_until([] { return video_device().empty() && gpio_chip().empty(); }, limit_s);
}

int start_program(const std::vector<std::string>& words, const std::string& socket) {
  ::setenv("FATHOM_VIDEO", video_device().c_str(), 1);
  ::setenv("FATHOM_GPIOCHIP", gpio_chip().c_str(), 1);
  ::setenv("FATHOM_USB_SOCKET", socket.c_str(), 1);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  const int error =
      ::posix_spawnp(&process, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (error != 0) throw std::runtime_error(words[0] + ": " + std::strerror(error));
  return process;
}

int exit_status(int process) {
  int status = 0;
  if (::waitpid(process, &status, WNOHANG) != process) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace fathom::usb
