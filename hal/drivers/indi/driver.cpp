// SPDX-License-Identifier: Apache-2.0
// The driver "indi": cameras and focusers of astronomy, behind a server of the INDI protocol 1.7.
//
// Camera and focuser have a connection each: they share nothing, may be used by two threads, and
// a picture on its way does not delay the news of a motor.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <memory>
#include <vector>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/indi/camera.hpp"
#include "hal/drivers/indi/focuser.hpp"

namespace fathom {
namespace {

using namespace indi;

// DRIVER_INTERFACE of INDI's basedevice.h
constexpr int kIsCamera = 1 << 1;
constexpr int kIsFocuser = 1 << 3;

constexpr std::int64_t kQuiet_ns = 150'000'000;
constexpr std::int64_t kFind_ns = 1'000'000'000;

/// The one that is asked where nobody names another.
Address usual_server() { return {.host = "localhost", .port = kUsualPort}; }

/// 0 for what is no number.
int bits_of(const Value& value) {
  const char* const end = value.text.data() + value.text.size();
  int bits = 0;
  const auto [next, problem] = std::from_chars(value.text.data(), end, bits);
  return problem == std::errc() && next == end && bits > 0 ? bits : 0;
}

std::vector<std::string> devices_that_are(Client& client, int interface) {
  std::vector<std::string> found;
  for (const std::string& device : client.devices().names()) {
    const Property* const info = client.devices().find(device, "DRIVER_INFO");
    const Value* const bits = info == nullptr ? nullptr : info->find("DRIVER_INTERFACE");
    if (bits != nullptr && (bits_of(*bits) & interface) != 0) {
      found.push_back(device);
    }
  }
  return found;
}

/// The device of a name or, without one, the only one of its kind; empty if the server has none.
std::string choose_device(Client& client, const std::string& wished, int interface,
                          const char* key) {
  if (!wished.empty()) {
    client.await(wished, "CONNECTION");
    return wished;
  }
  const std::int64_t deadline_ns = monotonic_now_ns() + client.timeout_ns();
  client.wait_unless_stopped([&] { return !devices_that_are(client, interface).empty(); },
                             deadline_ns);
  client.wait_until_quiet(kQuiet_ns, client.timeout_ns());
  const std::vector<std::string> found = devices_that_are(client, interface);
  if (found.size() <= 1) return found.empty() ? "" : found.front();
  throw Error(ErrorCode::bad_argument,
              fmt::format("{} has more than one {}: \"{}\"; say which with {}=NAME", client.where(),
                          key, fmt::join(found, "\", \""), key));
}

void require_connected(Client& client, const std::string& device) {
  const auto is_connected = [&] {
    const Property& connection = client.need(device, "CONNECTION");
    const Value* const on = connection.find("CONNECT");
    return on != nullptr && on->is_on && connection.state != State::busy;
  };
  client.await(device, "CONNECTION");
  if (is_connected()) return;
  std::string why = client.words_of(device);
  try {
    client.set_switch(device, "CONNECTION", "CONNECT");
    if (is_connected()) return;
    why = client.words_of(device);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::device_lost) throw;
    why = fmt::format(": {}", error.what());
  }
  throw Error(ErrorCode::unavailable,
              fmt::format("{} at {} does not connect{}; is it plugged in, and its port right?",
                          device, client.where(), why));
}

template <class Device>
std::unique_ptr<Device> open_device(const IndiSettings& settings, const OpenOptions& options,
                                    const std::string& wished, int interface, const char* key) {
  auto client =
      std::make_unique<Client>(settings.server, settings.timeout_ns, options.stop_requests);
  const std::string device = choose_device(*client, wished, interface, key);
  if (device.empty()) return nullptr;
  require_connected(*client, device);
  return std::make_unique<Device>(std::move(client), device, settings, options.stop_requests);
}

std::vector<FoundHardware> found_on(Client& client, const Address& address) {
  const auto cameras = devices_that_are(client, kIsCamera);
  const auto focusers = devices_that_are(client, kIsFocuser);
  const std::string where = address.text();
  if (cameras.size() <= 1 && focusers.size() <= 1) {
    if (cameras.empty() && focusers.empty()) return {};
    const std::string both = cameras.empty() || focusers.empty() ? "" : " and ";
    return {{"indi:" + where,
             fmt::format("INDI server: {}{}{}", cameras.empty() ? "" : "camera " + cameras[0], both,
                         focusers.empty() ? "" : "focuser " + focusers[0]),
             !cameras.empty(), !focusers.empty(), ""}};
  }
  std::vector<FoundHardware> found;
  for (const std::string& camera : cameras) {
    found.push_back({fmt::format("indi:server={},camera={}", where, camera),
                     "INDI camera " + camera, true, false, ""});
  }
  for (const std::string& focuser : focusers) {
    found.push_back({fmt::format("indi:server={},focuser={}", where, focuser),
                     "INDI focuser " + focuser, false, true, ""});
  }
  return found;
}

class IndiDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "indi"; }

  const char* summary() const noexcept override {
    return "cameras and focusers of an INDI server: indi:HOST:PORT (localhost:7624), camera=NAME, "
           "focuser=NAME, exposure_ms=MS, x=, y=, width=, height= (px of the chip), binning=N, "
           "gain=X, polling_ms=MS, timeout_s=S, stall_s=S, settle_ms=MS, backlash=STEPS; of a "
           "relative focuser: start=STEPS or home=true, travel=STEPS";
  }

  const char* bare_key() const noexcept override { return "server"; }

  bool has_lens_traits() const noexcept override { return true; }

  std::vector<FoundHardware> find() const override {
    try {
      const Address address = usual_server();
      const std::int64_t deadline_ns = monotonic_now_ns() + kFind_ns;
      Client client(address, kFind_ns - kQuiet_ns);
      client.wait_until_quiet(kQuiet_ns, deadline_ns - monotonic_now_ns());
      return found_on(client, address);
    } catch (const Error&) {  // no server, or none that speaks INDI: nothing is plugged in
      return {};
    }
  }

  std::string obstacle() const override {
    try {
      const Client client(usual_server(), kFind_ns);
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  }

  Hardware open(const RigSettings& settings, const OpenOptions& options) const override {
    const IndiSettings wishes = IndiSettings::read(settings);
    settings.require_all_used();
    Hardware hardware;
    if (options.camera) {
      hardware.camera =
          open_device<IndiCamera>(wishes, options, wishes.camera, kIsCamera, "camera");
    }
    if (options.lens) {
      hardware.lens =
          open_device<IndiFocuser>(wishes, options, wishes.focuser, kIsFocuser, "focuser");
    }
    return hardware;
  }
};

}  // namespace

const RigDriver& indi_driver() {
  static const IndiDriver driver;
  return driver;
}

}  // namespace fathom
