// SPDX-License-Identifier: Apache-2.0
// Asks a service over HTTP/1.1, one request after the other, and never waits longer than it is told.
//
// Why not the client of cpp-httplib, which serves the other side? It waits without asking whether
// somebody wants it to stop, its time limit is that of one read, and whoever uses the installed
// library would have to have it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/drivers/http/answer.hpp"
#include "hal/drivers/http/place.hpp"
#include "hal/socket.hpp"
#include "hal/stop.hpp"

namespace fathom::http {

struct Request {
  std::string path;                      ///< "/api/v1/state".
  std::optional<std::string> body = {};  ///< JSON, for a POST; a GET without.
  std::size_t most_bytes = 16 << 20;     ///< Of the answer.
};

class Client {
 public:
  /// name: of this client, as the service tells it to others.
  Client(Place place, std::string name);

  /// The answer, whatever it says. Throws Error(unavailable) where nobody listens, Error(timeout)
  /// after the deadline (monotonic clock), Error(device_lost) where the connection breaks,
  /// Error(bad_data) for what is no HTTP, Error(cancelled) where a stop is requested.
  Answer ask(const Request& request, std::int64_t deadline_ns, const StopRequests& stop_requests);

  const std::string& where() const { return where_; }

 private:
  std::string text_of(const Request& request) const;
  std::optional<Answer> exchange(const std::string& text, const Request& request,
                                 std::int64_t deadline_ns);

  Place place_;
  std::string name_;
  std::string where_;
  StopRequests stop_requests_ = never_stop;  ///< Of what is asked now; the socket looks at it.
  std::optional<Socket> socket_;             ///< Kept where the last answer allows it.
};

}  // namespace fathom::http
