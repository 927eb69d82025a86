// SPDX-License-Identifier: Apache-2.0
// Cameras and focusers of ASCOM Alpaca: an HTTP server that each device, or a computer near it, has.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <vector>

#include "engine/error.hpp"
#include "hal/drivers/alpaca/camera.hpp"
#include "hal/drivers/alpaca/discovery.hpp"
#include "hal/drivers/alpaca/focuser.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace {

using namespace alpaca;

constexpr std::int64_t kListen_ns = 400'000'000;
constexpr std::int64_t kFind_ns = 500'000'000;

/// "camera/0" of a name, a number or of nothing, where there is one; empty where there is none.
std::string choose(Connection& connection, const std::string& wished, const std::string& kind) {
  std::vector<DeviceEntry> found;
  for (DeviceEntry& device : connection.devices()) {
    const bool is_wished =
        wished.empty() || wished == device.name || wished == std::to_string(device.number);
    if (device.kind == kind && is_wished) found.push_back(std::move(device));
  }
  if (found.size() == 1) return fmt::format("{}/{}", kind, found.front().number);
  const std::string where = connection.address().text();
  if (found.empty() && wished.empty()) return {};
  if (found.empty()) {
    throw Error(ErrorCode::unavailable,
                fmt::format("{} has no {} \"{}\"; `fathom rigs list` shows what answers", where,
                            kind, wished));
  }
  std::vector<std::string> names;
  for (const DeviceEntry& device : found)
    names.push_back(fmt::format("{} ({})", device.number, device.name));
  throw Error(ErrorCode::bad_argument,
              fmt::format("{} has more than one {}: {}; say which with {}=NUMBER", where, kind,
                          fmt::join(names, ", "), kind));
}

template <class Device, class Keys>
std::unique_ptr<Device> open_device(const alpaca::Settings& settings, const OpenOptions& options,
                                    const std::string& wished, const char* kind, const Keys& keys) {
  auto connection = std::make_unique<Connection>(settings.server, settings.timeout_ns);
  const std::string device = choose(*connection, wished, kind);
  if (device.empty()) return nullptr;
  return std::make_unique<Device>(std::move(connection), device, keys, options.stop_requests);
}

/// One rig for a server that has one of each; else each device by its number.
std::vector<FoundHardware> found_on(const Address& address) {
  Connection connection(address, kFind_ns);
  std::vector<FoundHardware> found;
  FoundHardware both{"alpaca:" + address.text(), "Alpaca server:", false, false, ""};
  bool is_plain = true;
  for (const DeviceEntry& device : connection.devices()) {
    const bool is_camera = device.kind == "camera", is_focuser = device.kind == "focuser";
    if (!is_camera && !is_focuser) continue;
    bool& has = is_camera ? both.has_camera : both.has_lens;
    is_plain = is_plain && !has;
    has = true;
    both.description += fmt::format(" {} {} ({})", device.kind, device.number, device.name);
    found.push_back({fmt::format("alpaca:{},{}={}", address.text(), device.kind, device.number),
                     fmt::format("Alpaca {} {}", device.kind, device.name), is_camera, is_focuser,
                     ""});
  }
  if (!is_plain || found.empty()) return found;
  return {both};
}

class AlpacaDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "alpaca"; }

  const char* summary() const noexcept override {
    return "cameras and focusers of an ASCOM Alpaca server: alpaca:HOST:PORT (localhost:11111), "
           "camera=N, focuser=N, exposure_ms=MS, binning=N, x=, y=, width=, height= (px of the "
           "binned picture), gain=X, timeout_s=S, stall_s=S, lowest, highest, settle_ms=MS, "
           "backlash=STEPS; of a relative focuser: start=STEPS, travel=STEPS";
  }

  const char* bare_key() const noexcept override { return "server"; }
  bool has_lens_traits() const noexcept override { return true; }

  std::vector<FoundHardware> find() const override {
    std::vector<FoundHardware> found;
    for (const Address& address : discover(kListen_ns)) {
      try {
        for (FoundHardware& one : found_on(address)) found.push_back(std::move(one));
      } catch (const Error& error) {
        found.push_back({"alpaca:" + address.text(), "Alpaca server", false, false, error.what()});
      }
    }
    return found;
  }

  Hardware open(const RigSettings& rig, const OpenOptions& options) const override {
    const alpaca::Settings settings = alpaca::Settings::read(rig);
    rig.require_all_used();  // before anything is asked of a server
    Hardware hardware;
    if (options.lens) {
      hardware.lens = open_device<AlpacaFocuser>(settings, options, settings.focuser, "focuser",
                                                 settings.focuser_keys);
    }
    if (options.camera) {
      hardware.camera = open_device<AlpacaCamera>(settings, options, settings.camera, "camera",
                                                  settings.camera_keys);
    }
    return hardware;
  }
};

}  // namespace

const RigDriver& alpaca_driver() {
  static const AlpacaDriver driver;
  return driver;
}

}  // namespace fathom
