// SPDX-License-Identifier: Apache-2.0
// The HTTP server: lets in, limits and answers.
#pragma once

#include <httplib.h>

#include <condition_variable>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "serve/admission.hpp"
#include "serve/api.hpp"
#include "serve/connection.hpp"

namespace fathom::serve {

struct ServiceOptions {
  std::string bind = "127.0.0.1";  ///< A number, or a name of this computer.
  int port = 8470;                 ///< 0: one that is free.
  std::string token;
  std::vector<std::string> names = {};  ///< That may stand in Host, beside this computer's own.
  ConnectionLimits limits = {};
  std::size_t most_connections = 128;
};

class Service final : private httplib::Server {
 public:
  /// Takes the port; the api must outlive this. Throws Error(unavailable) where it cannot, and
  /// Error(bad_argument) for a token that require_token() refuses.
  Service(const ServiceOptions& options, Api& api);
  ~Service() override = default;

  int port() const { return port_; }
  const std::string& token() const { return house_.token; }
  /// The address to open, with the token.
  std::string address() const;

  /// Serves until stop(), also where that came first.
  void run();
  /// To be called from another thread, once, after the feeds were closed. Whoever is still being
  /// answered then has a moment for it.
  void stop();

 private:
  bool process_and_close_socket(socket_t socket) override;
  void serve_one(socket_t socket);
  void set_up();
  void bind();
  void add_pages();
  void add_route(const Route& route);
  HandlerResponse let_in(const httplib::Request& request, httplib::Response& response);
  bool is_greeting(const httplib::Request& request) const;
  void greet(httplib::Response& response) const;

  ServiceOptions options_;
  Api& api_;
  House house_;
  int port_ = 0;
  std::mutex mutex_;
  std::condition_variable closed_;
  std::set<socket_t> open_;
};

}  // namespace fathom::serve
