// SPDX-License-Identifier: Apache-2.0
// A TCP connection on which nothing waits longer than it is told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

struct addrinfo;

namespace fathom::indi {

struct Address {
  std::string host = "localhost";
  std::string port = "7624";  ///< INDI's own.

  std::string text() const { return host + ":" + port; }
};

/// Reads "HOST", "HOST:PORT" or "[IPV6]:PORT". Throws Error(bad_argument).
Address parse_address(std::string_view text);

class Socket {
 public:
  /// Connects until a time on the monotonic clock. Throws Error(unavailable) where nobody listens
  /// or no such host is known, Error(timeout).
  Socket(const Address& address, std::int64_t deadline_ns);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  /// Sends all of it. Throws Error(device_lost) if the other side is gone, Error(timeout) if it
  /// does not take it.
  void send(std::string_view bytes, std::int64_t deadline_ns);

  /// What has come, at most the room's size; 0 if nothing comes until the deadline. Throws
  /// Error(device_lost) once the other side has closed.
  std::size_t receive(std::span<char> room, std::int64_t deadline_ns);

 private:
  bool connect_to(const addrinfo& target, std::int64_t deadline_ns);
  bool wait_for(short events, std::int64_t deadline_ns) const;

  Address address_;
  int handle_ = -1;
  int problem_ = 0;  // errno of the last failed connection
};

}  // namespace fathom::indi
