// SPDX-License-Identifier: Apache-2.0
// Everything that can be asked for over HTTP: one table, from which the addresses are served and
// their description is written. docs/http.md tells of it.
#pragma once

#include <httplib.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "engine/error.hpp"
#include "serve/drive.hpp"
#include "serve/operator.hpp"
#include "serve/run_shelf.hpp"

namespace fathom::serve {

/// There are as many streams as there may be.
class TooMany : public Error {
 public:
  TooMany() : Error(ErrorCode::unavailable, "too many watch already; try again later") {}
};

/// A member of a body, or a parameter of a query.
struct Field {
  const char* name;
  const char* type;  ///< "number", "string", "array", "integer", "boolean".
  const char* help;
};

/// Who may ask.
enum class Right {
  watch,   ///< Everybody with the token.
  stop,    ///< Likewise, but not of a service that only shows.
  driver,  ///< One client at a time, and not of such a service either.
};

struct Route {
  const char* method;  ///< "GET" or "POST".
  const char* path;    ///< Below /api/v1/; {id} stands for a name.
  const char* help;
  const char* gives;  ///< Media type of the answer.
  Right right = Right::watch;
  std::vector<Field> fields = {};  ///< Of the query of a GET, of the body of a POST.
  std::function<void(const httplib::Request&, httplib::Response&)> handle;
};

class Api {
 public:
  /// All of them must outlive this.
  Api(Operator& rig, Publisher& publisher, const std::filesystem::path& folder, bool is_read_only,
      const Clock& clock);
  Api(const Api&) = delete;
  Api& operator=(const Api&) = delete;

  const std::vector<Route>& routes() const { return routes_; }
  /// Answers by a route: checks who asks, and puts errors into the answer.
  void answer(const Route& route, const httplib::Request& request, httplib::Response& response);
  /// OpenAPI 3, JSON.
  std::string description() const;

  /// How many watch a stream; one more is refused.
  static constexpr int kMostStreams = 80;

 private:
  void add_looks();
  void add_commands();
  void add_measurements();
  void add_runs();
  void add_rig();
  void add_rig_moves();
  void add_rig_stage();
  void add(Route route) { routes_.push_back(std::move(route)); }
  void add_order(Activity kind, const char* help, std::vector<Field> fields);

  void require_right(const Route& route, const httplib::Request& request);
  std::string state_json(const std::string& client) const;
  std::string drive_json(const std::string& client) const;
  void change_drive(const std::string& client, const std::string& action);
  void send_taken(const httplib::Request& request, httplib::Response& response);
  void send_frame(const httplib::Request& request, httplib::Response& response);
  void stream_pictures(const httplib::Request& request, httplib::Response& response);
  void stream_events(const httplib::Request& request, httplib::Response& response);
  /// How far somebody has read the events.
  struct EventReader {
    std::string client;
    std::uint64_t next = 0;
    std::int64_t told_ns = 0;
    bool has_begun = false;
  };
  void add_event_reader(const std::string& client, int change);
  std::optional<std::string> news_for(EventReader& reader);
  bool send_events(EventReader& reader, httplib::DataSink& sink);
  std::string event_text(const Event& event, const std::string& client) const;
  void begin_stream();
  /// Tells everybody when the driver has gone, or another one has come.
  void notice_driver();

  Operator& rig_;
  Publisher& publisher_;
  RunShelf shelf_;
  bool is_read_only_;
  std::atomic<int> streams_ = 0;
  mutable std::mutex drive_mutex_;
  Drive drive_;
  std::optional<std::string> told_driver_;  // as watchers know it
  std::vector<Route> routes_;
};

/// Which client asks; "anonymous" where it does not say, or not well.
std::string client_of(const httplib::Request& request);

/// Puts {"error":{"code":..,"message":..}} into an answer.
void set_error(httplib::Response& response, int status, std::string_view code,
               std::string_view message);

}  // namespace fathom::serve
