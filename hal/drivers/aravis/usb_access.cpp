// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/usb_access.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <string>

namespace fathom::aravis {
namespace {

namespace fs = std::filesystem;

/// USB3 Vision: an interface of the class "miscellaneous", subclass 5, whose protocol 0 is the control.
constexpr const char* kClass[][2] = {
    {"bInterfaceClass", "ef"}, {"bInterfaceSubClass", "05"}, {"bInterfaceProtocol", "00"}};

std::string line_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

bool is_camera(const fs::path& interface) {
  for (const auto& [file, value] : kClass) {
    if (line_of(interface / file) != value) return false;
  }
  return true;
}

/// 0 for what is no number.
int number_of(const fs::path& file) {
  const std::string line = line_of(file);
  int number = 0;
  std::from_chars(line.data(), line.data() + line.size(), number);
  return number;
}

}  // namespace

std::vector<FoundHardware> unreadable_usb_cameras() {
  std::vector<FoundHardware> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/sys/bus/usb/devices", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.find(':') == std::string::npos || !is_camera(entry.path())) continue;
    const fs::path device = entry.path().parent_path() / name.substr(0, name.find(':'));
    const std::string node = fmt::format("/dev/bus/usb/{:03}/{:03}", number_of(device / "busnum"),
                                         number_of(device / "devnum"));
    if (access(node.c_str(), R_OK | W_OK) == 0) continue;
    const std::string model = line_of(device / "product");
    found.push_back({"aravis:" + line_of(device / "serial"), model + " on USB", true, false,
                     fmt::format("no permission for {}: a udev rule gives it (Debian: "
                                 "/lib/udev/rules.d/*aravis*, or group plugdev)",
                                 node)});
  }
  return found;
}

}  // namespace fathom::aravis
