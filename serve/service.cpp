// SPDX-License-Identifier: Apache-2.0
#include "serve/service.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <string_view>
#include <system_error>

#include "engine/error.hpp"
#include "serve/connection_pool.hpp"
#include "serve/page_files.hpp"
#include "session/json_line.hpp"

namespace fathom::serve {
namespace {

using httplib::Request;
using httplib::Response;

/// What every answer says to a browser.
const httplib::Headers kHeaders = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
     "connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; "
     "frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Referrer-Policy", "no-referrer"},
    {"Cache-Control", "no-store"}};

std::string plain_answer(std::string_view status, std::string_view code, std::string_view words) {
  const std::string error = JsonLine().add("code", code).add("message", words).text();
  const std::string body = JsonLine().add_json("error", error).text();
  return fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: application/json\r\nContent-Length: {}\r\n"
      "X-Content-Type-Options: nosniff\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n{}",
      status, body.size(), body);
}

std::string answer_to(Trouble trouble) {
  switch (trouble) {
    case Trouble::none:
    case Trouble::gone:
      return "";
    case Trouble::large_head:
      return plain_answer("431 Request Header Fields Too Large", "large_head",
                          "address and headers have 8192 bytes at most");
    case Trouble::large_body:
      return plain_answer("413 Payload Too Large", "large_body", words_of(Refusal::large_body));
    case Trouble::slow:
      return plain_answer("408 Request Timeout", "slow", "the request took too long to come");
  }
  return "";
}

std::vector<std::string> values_of(const Request& request, const char* name) {
  std::vector<std::string> values;
  const auto [first, last] = request.headers.equal_range(name);
  for (auto header = first; header != last; ++header) values.push_back(header->second);
  return values;
}

Visitor visitor_of(const Request& request) {
  return {.method = request.method,
          .path = request.path,
          .hosts = values_of(request, "Host"),
          .origins = values_of(request, "Origin"),
          .content_type = request.get_header_value("Content-Type"),
          .lengths = values_of(request, "Content-Length"),
          .is_chunked = request.has_header("Transfer-Encoding"),
          .cookie = request.get_header_value("Cookie"),
          .authorization = request.get_header_value("Authorization"),
          .query_token = request.get_param_value("token")};
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// What this computer calls itself, in its own network too.
void add_own_names(std::vector<std::string>& names, const std::string& bind) {
  for (std::string& name : names) name = lower(name);
  names.push_back(lower(bind));
  std::array<char, 256> own{};
  if (::gethostname(own.data(), own.size() - 1) != 0 || own[0] == '\0') return;
  const std::string name = lower(own.data());
  names.push_back(name);
  names.push_back(name.substr(0, name.find('.')) + ".local");
}

/// Two programs must not share a port, and pictures that are late are worth nothing.
void set_options(socket_t socket) {
  constexpr int kYes = 1, kSendBytes = 128 << 10;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &kYes, sizeof kYes);
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBytes, sizeof kSendBytes);
}

/// Whether another request may follow the one that this thread answers.
thread_local bool goes_on = false;

/// Only what was asked without a body, and answered as a whole, may be followed by another request:
/// nothing that was refused unread can then be taken for one.
void decide_to_go_on(const Request& request, Response& response) {
  goes_on = request.method == "GET" && response.status == 200 && !response.content_provider_ &&
            request.get_header_value("Connection") != "close";
  if (goes_on) return;
  response.headers.erase("Keep-Alive");
  response.headers.erase("Connection");
  response.set_header("Connection", "close");
}

/// A route's address as a pattern of the HTTP library.
std::string pattern_of(std::string path) {
  const std::size_t dot = path.find('.');
  if (dot != std::string::npos) path.replace(dot, 1, "\\.");
  const std::size_t name = path.find("{id}");
  if (name != std::string::npos) path.replace(name, 4, "([A-Za-z0-9._-]+)");
  return "/api/v1/" + path;
}

}  // namespace

Service::Service(const ServiceOptions& options, Api& api) : options_(options), api_(api) {
  house_.token = options.token.empty() ? random_token() : options.token;
  require_token(house_.token);
  house_.names = options.names;
  add_own_names(house_.names, options.bind);
  set_up();
  bind();
  house_.cookie_name = fmt::format("fathom_token_{}", port_);
}

void Service::set_up() {
  new_task_queue = [this] { return new ConnectionPool(options_.most_connections); };
  set_socket_options(set_options);
  set_tcp_nodelay(true);
  set_default_headers(kHeaders);
  set_payload_max_length(kMostBodyBytes);
  set_pre_routing_handler(
      [this](const Request& request, Response& response) { return let_in(request, response); });
  set_post_routing_handler(decide_to_go_on);
  set_keep_alive_timeout(options_.limits.idle_ms / 1000);  // for what it tells clients
  set_error_handler([](const Request&, Response& response) {
    if (response.body.empty())
      set_error(response, response.status, "not_found", "there is nothing here; see /api");
  });
  set_exception_handler([](const Request&, Response& response, std::exception_ptr problem) {
    try {
      std::rethrow_exception(problem);
    } catch (const std::exception& error) {
      set_error(response, 500, "internal", error.what());
    }
  });
  add_pages();
  for (const Route& route : api_.routes()) add_route(route);
}

void Service::bind() {
  constexpr int kBacklog = 128;
  if (options_.port == 0) {
    port_ = bind_to_any_port(options_.bind);
  } else {
    port_ = bind_to_port(options_.bind, options_.port) ? options_.port : -1;
  }
  if (port_ <= 0) {
    const int why = errno;
    throw Error(ErrorCode::unavailable,
                fmt::format("cannot listen at {} port {}: {}; name another with --port",
                            options_.bind, options_.port,
                            why != 0 ? std::generic_category().message(why) : "no such address"));
  }
  ::listen(svr_sock_, kBacklog);
}

void Service::add_pages() {
  Get("/api", [this](const Request&, Response& response) {
    response.set_content(api_.description(), "application/json");
  });
  const auto send = [](const PageFile& file) {
    return [&file](const Request&, Response& response) {
      response.set_content(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size(),
                           file.type);
    };
  };
  for (const PageFile& file : page_files()) {
    const std::string name(file.name);
    // Names of ours have no sign of a pattern but the dot.
    std::string pattern = "/page/" + name;
    for (std::size_t dot = pattern.find('.'); dot != std::string::npos;
         dot = pattern.find('.', dot + 2))
      pattern.insert(dot, "\\");
    Get(pattern, send(file));
    if (name == "index.html") Get("/", send(file));
  }
}

void Service::add_route(const Route& route) {
  const auto handle = [this, &route](const Request& request, Response& response) {
    api_.answer(route, request, response);
  };
  if (std::string_view(route.method) == "GET") {
    Get(pattern_of(route.path), handle);
  } else {
    Post(pattern_of(route.path), handle);
  }
}

/// The address that was printed was opened.
bool Service::is_greeting(const Request& request) const {
  return request.path == "/" && request.method == "GET" && request.has_param("token");
}

void Service::greet(Response& response) const {
  response.set_header("Set-Cookie", fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/",
                                                house_.cookie_name, house_.token));
  response.set_redirect("/", 303);
}

Service::HandlerResponse Service::let_in(const Request& request, Response& response) {
  const Refusal refusal = admit(visitor_of(request), house_);
  if (refusal != Refusal::none) {
    set_error(response, status_of(refusal), code_of(refusal), words_of(refusal));
    return HandlerResponse::Handled;
  }
  if (!is_greeting(request)) return HandlerResponse::Unhandled;
  greet(response);
  return HandlerResponse::Handled;
}

std::string Service::address() const {
  const bool is_everywhere = options_.bind == "0.0.0.0" || options_.bind == "::";
  std::array<char, 256> own{"localhost"};
  if (is_everywhere) ::gethostname(own.data(), own.size() - 1);
  std::string host = is_everywhere ? own.data() : options_.bind;
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  return fmt::format("http://{}:{}/?token={}", host, port_, house_.token);
}

void Service::serve_one(socket_t socket) {
  constexpr int kMostRequests = 100;
  Connection connection(socket, options_.limits);
  for (int i = 0; i < kMostRequests; ++i) {
    bool is_closed = false;
    goes_on = false;
    process_request(connection, false, is_closed, [](Request& request) { request.ranges.clear(); });
    const std::string text = answer_to(connection.trouble());
    if (!text.empty()) connection.answer(text);
    if (!goes_on || is_closed || !is_running() || !connection.begins_another()) return;
  }
}

bool Service::process_and_close_socket(socket_t socket) {
  if (ConnectionPool::is_refusing()) {
    turn_away(socket, plain_answer("429 Too Many Requests", "too_many",
                                   "too many connections; try again later"));
    return false;
  }
  {
    const std::lock_guard lock(mutex_);
    open_.insert(socket);
  }
  serve_one(socket);
  {
    const std::lock_guard lock(mutex_);
    open_.erase(socket);
    closed_.notify_all();
  }
  close_gently(socket);
  return true;
}

void Service::run() { listen_after_bind(); }

void Service::stop() {
  std::unique_lock lock(mutex_);
  // The HTTP library cuts off every stream when it stops, also what it was about to say.
  closed_.wait_for(lock, std::chrono::milliseconds(500), [this] { return open_.empty(); });
  // It takes no wish to stop before it runs. Then it is let run, into a port that takes nobody.
  if (is_running())
    httplib::Server::stop();
  else
    ::shutdown(svr_sock_, SHUT_RDWR);
  for (const socket_t socket : open_) ::shutdown(socket, SHUT_RDWR);
}

}  // namespace fathom::serve
