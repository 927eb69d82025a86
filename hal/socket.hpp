// SPDX-License-Identifier: Apache-2.0
// A TCP connection on which nothing waits longer than it is told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hal/stop.hpp"

struct addrinfo;

namespace fathom {

struct Address {
  std::string host = "localhost";
  std::string port;

  std::string text() const { return host + ":" + port; }
};

/// Reads "HOST", "HOST:PORT" or "[IPV6]:PORT"; without a port it is `usual_port`. Nothing where the
/// text is none of them.
std::optional<Address> parse_address(std::string_view text, std::string_view usual_port);

/// Who is at the other end, for messages.
struct Peer {
  Address address;
  std::string kind;    ///< "INDI server".
  std::string advice;  ///< Where nobody listens: "start one, or ...".

  std::string text() const { return kind + " " + address.text(); }
};

class Socket {
 public:
  /// Connects until a time on the monotonic clock. Throws Error(unavailable) where nobody listens
  /// or no such host is known, Error(timeout). A wish to stop ends this and send() with
  /// Error(cancelled). The requests must outlive this.
  Socket(Peer peer, std::int64_t deadline_ns, const StopRequests& stop_requests);
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
  bool wait_in_slices(short events, std::int64_t deadline_ns) const;

  Peer peer_;
  const StopRequests& stop_requests_;
  int handle_ = -1;
  int problem_ = 0;  // errno of the last failed connection
};

}  // namespace fathom
