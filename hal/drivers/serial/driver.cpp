// SPDX-License-Identifier: Apache-2.0
// A motor, stage or focuser that is told what to do in lines of text over a serial port.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <system_error>

#include "hal/drivers/serial/serial_lens.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace {

namespace fs = std::filesystem;
using namespace serial;

/// The ports that something is plugged into, by the names that stay the same where there are such.
std::vector<fs::path> plugged_in() {
  std::vector<fs::path> ports, plain;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/dev/serial/by-id", ignored)) {
    ports.push_back(entry.path());
  }
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("ttyUSB") || name.starts_with("ttyACM")) plain.push_back(entry.path());
  }
  if (ports.empty()) ports = plain;
  std::sort(ports.begin(), ports.end());
  return ports;
}

std::string problem_of(const fs::path& port) {
  if (access(port.c_str(), R_OK | W_OK) == 0) return {};
  return "no permission: is this user in the group dialout? (then log in again)";
}

class SerialDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "serial"; }

  const char* summary() const noexcept override {
    return "a stage, focuser or motor that speaks lines of text, beside a camera in a rig file: "
           "port "
           "= \"/dev/ttyUSB0\", profile = \"grbl\" (or marlin, zaber, pi, asi, prior, moonlite, "
           "sketch, FILE.toml), lowest, highest";
  }

  const char* bare_key() const noexcept override { return "port"; }

  std::span<const std::string_view> path_keys() const noexcept override {
    static constexpr std::string_view kKeys[] = {"state", "profile"};
    return kKeys;
  }

  bool has_lens_traits() const noexcept override { return true; }

  std::vector<FoundHardware> find() const override {
    std::vector<FoundHardware> found;
    for (const fs::path& port : plugged_in()) {
      found.push_back({"serial:" + port.string(),
                       "a serial port; what hangs on it says the profile in a rig file", false,
                       true, problem_of(port)});
    }
    return found;
  }

  Hardware open(const RigSettings& rig, const OpenOptions& options) const override {
    const Settings settings = Settings::read(rig);
    rig.require_all_used();  // before anything is said
    if (!options.lens) return {};
    return {nullptr, std::make_unique<SerialLens>(settings, options.stop_requests), nullptr};
  }
};

}  // namespace

const RigDriver& serial_driver() {
  static const SerialDriver driver;
  return driver;
}

}  // namespace fathom
