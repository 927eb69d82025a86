// SPDX-License-Identifier: Apache-2.0
// Questions to an ASCOM Alpaca server and its answers: HTTP, JSON, and pictures as bytes.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "hal/socket.hpp"

namespace httplib {
class Client;
struct Request;
}  // namespace httplib

namespace fathom::alpaca {

/// Where a server listens unless it says otherwise.
inline constexpr std::string_view kUsualPort = "11111";

/// One device that a server has.
struct DeviceEntry {
  std::string kind;  ///< "camera", "focuser", ...; in lower case.
  int number = 0;
  std::string name;
};

/// Each answer comes within the timeout or is an Error(timeout). Who does not answer at all is
/// Error(unavailable) at first, and Error(device_lost) later. What is no answer is Error(bad_data). What
/// the server refuses is Error(unsupported), or Error(device_lost) for a device that is not connected.
class Connection {
 public:
  Connection(const Address& address, std::int64_t timeout_ns);
  ~Connection();

  const Address& address() const { return address_; }
  std::int64_t timeout_ns() const { return timeout_ns_; }

  std::vector<DeviceEntry> devices();

  /// device: "camera/0". The value of a property, which may be spelled as ASCOM does ("NumX").
  double number(const std::string& device, const std::string& property);
  bool flag(const std::string& device, const std::string& property);
  std::string text(const std::string& device, const std::string& property);
  /// parameters: "Position=3", as a form has them. Their names are spelled as ASCOM does: there are
  /// servers that know no other.
  void put(const std::string& device, const std::string& method, const std::string& parameters);

  /// A picture as it was sent, and whether as bytes; else it is JSON. most_bytes: more is refused.
  struct Picture {
    std::string body;
    bool is_bytes = false;
  };
  Picture picture(const std::string& device, std::size_t most_bytes);

 private:
  struct Answer {
    std::string body;
    std::string type;
  };
  Answer ask(httplib::Request& request, std::size_t most_bytes);
  nlohmann::json value(const std::string& path);
  nlohmann::json checked(const std::string& body, const std::string& what);
  std::string numbers();

  Address address_;
  std::int64_t timeout_ns_;
  std::unique_ptr<httplib::Client> client_;
  std::uint32_t transaction_ = 0;
  bool has_answered_ = false;
};

/// Throws what an error number of the protocol means; nothing for 0.
void require_no_error(long long number, std::string_view message, const std::string& what);

}  // namespace fathom::alpaca
