// SPDX-License-Identifier: Apache-2.0
// Rights, errors and the description. api_routes.cpp has the table, streams.cpp what never ends.
#include "serve/api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "engine/error.hpp"
#include "serve/admission.hpp"
#include "session/json_line.hpp"

namespace fathom::serve {
namespace {

/// Somebody may not do this.
class NotAllowed : public Error {
 public:
  NotAllowed(const char* code, std::string_view words)
      : Error(ErrorCode::unavailable, words), code_(code) {}
  const char* name() const { return code_; }

 private:
  const char* code_;
};

int status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_argument:
    case ErrorCode::out_of_bounds:
      return 400;
    case ErrorCode::unavailable:
    case ErrorCode::cancelled:
    case ErrorCode::unsupported:
      return 409;
    case ErrorCode::timeout:
    case ErrorCode::device_lost:
      return 503;
    case ErrorCode::bad_data:
    case ErrorCode::io:
    case ErrorCode::out_of_memory:
      break;
  }
  return 500;
}

}  // namespace

void set_error(httplib::Response& response, int status, std::string_view code,
               std::string_view message) {
  response.status = status;
  const std::string error = JsonLine().add("code", code).add("message", message).text();
  response.set_content(JsonLine().add_json("error", error).text(), "application/json");
}

std::string client_of(const httplib::Request& request) {
  std::string name = request.get_header_value("X-Fathom-Client");
  if (name.empty()) name = request.get_param_value("client");
  return is_client_name(name) ? name : "anonymous";
}

Api::Api(Operator& rig, Publisher& publisher, const std::filesystem::path& folder,
         bool is_read_only, const Clock& clock)
    : rig_(rig),
      publisher_(publisher),
      shelf_(runs_folder(folder)),
      is_read_only_(is_read_only),
      drive_(clock) {
  add_looks();
  add_commands();
  add_measurements();
  add_runs();
  add_rig();
}

void Api::require_right(const Route& route, const httplib::Request& request) {
  if (route.right == Right::watch) return;
  if (is_read_only_)
    throw NotAllowed("read_only", "this service only shows (it was started with --read-only)");
  if (route.right == Right::stop) return;
  bool may_command = false;
  {
    const std::lock_guard lock(drive_mutex_);
    may_command = drive_.may_command(client_of(request));
  }
  if (!may_command) throw NotAllowed("not_driver", "somebody else drives; ask for it (POST drive)");
  notice_driver();
}

void Api::notice_driver() {
  const std::lock_guard lock(drive_mutex_);
  const std::optional<std::string> now = drive_.driver();
  if (now == told_driver_) return;
  told_driver_ = now;
  publisher_.events.tell("drive", "");
}

void Api::answer(const Route& route, const httplib::Request& request, httplib::Response& response) {
  try {
    require_right(route, request);
    response.status = 200;
    route.handle(request, response);
  } catch (const NotAllowed& refusal) {
    set_error(response, 403, refusal.name(), refusal.what());
  } catch (const Busy& busy) {
    set_error(response, 409, "busy", busy.what());
  } catch (const TooMany& many) {
    set_error(response, 429, "too_many", many.what());
  } catch (const Error& error) {
    set_error(response, status_of(error.code()), to_string(error.code()), error.what());
  }
}

std::string Api::drive_json(const std::string& client) const {
  const std::lock_guard lock(drive_mutex_);
  const std::optional<std::string> driver = drive_.driver();
  std::string asking;
  for (const std::string& one : drive_.asking())
    asking += (asking.empty() ? "\"" : ",\"") + one + "\"";
  JsonLine line;
  line.add_json("you", driver == client ? "true" : "false");
  driver ? line.add("driver", *driver) : line.add_null("driver");
  return line.add_json("asking", "[" + asking + "]").text();
}

std::string Api::state_json(const std::string& client) const {
  return JsonLine()
      .add_members(publisher_.board.read(state_members))
      .add_json("drive", drive_json(client))
      .add("clients", publisher_.events.readers())
      .text();
}

void Api::change_drive(const std::string& client, const std::string& action) {
  {
    const std::lock_guard lock(drive_mutex_);
    if (action == "ask") drive_.ask(client);
    if (action == "take") drive_.take(client);
    if (action == "give") drive_.give(client);
    if (action == "refuse") drive_.refuse(client);
    told_driver_ = drive_.driver();
  }
  publisher_.events.tell("drive", "");
}

namespace {

std::string schema_of(const Field& field) {
  return JsonLine().add("type", field.type).add("description", field.help).text();
}

std::string parameters_of(const Route& route) {
  std::string list;
  const auto add = [&](const char* name, const char* where, const std::string& schema, bool must) {
    list += list.empty() ? "" : ",";
    list += JsonLine()
                .add("name", name)
                .add("in", where)
                .add_json("required", must ? "true" : "false")
                .add_json("schema", schema)
                .text();
  };
  if (std::string_view(route.path).find("{id}") != std::string_view::npos)
    add("id", "path", "{\"type\":\"string\"}", true);
  if (std::string_view(route.method) == "GET") {
    for (const Field& field : route.fields) add(field.name, "query", schema_of(field), false);
  }
  return "[" + list + "]";
}

std::string body_of(const Route& route) {
  JsonLine properties;
  for (const Field& field : route.fields) properties.add_json(field.name, schema_of(field));
  const std::string schema = JsonLine()
                                 .add("type", "object")
                                 .add_json("properties", properties.text())
                                 .add_json("additionalProperties", "false")
                                 .text();
  return fmt::format("{{\"content\":{{\"application/json\":{{\"schema\":{}}}}}}}", schema);
}

std::string operation_of(const Route& route) {
  JsonLine line;
  line.add("summary", route.help).add_json("parameters", parameters_of(route));
  if (std::string_view(route.method) == "POST") line.add_json("requestBody", body_of(route));
  const std::string gives = route.gives;
  line.add_json("responses",
                fmt::format("{{\"200\":{{\"description\":\"done\",\"content\":{{\"{}\":{{}}}}}},"
                            "\"4XX\":{{\"description\":\"error.code and error.message\"}}}}",
                            gives));
  return line.text();
}

}  // namespace

std::string Api::description() const {
  JsonLine paths;
  for (std::size_t i = 0; i < routes_.size(); ++i) {
    const Route& route = routes_[i];
    const std::string method = std::string_view(route.method) == "GET" ? "get" : "post";
    paths.add_json(fmt::format("/api/v1/{}", route.path),
                   JsonLine().add_json(method, operation_of(route)).text());
  }
  const std::string version = publisher_.board.read([](const State& now) { return now.version; });
  return JsonLine()
      .add("openapi", "3.0.3")
      .add_json("info", JsonLine().add("title", "Fathom").add("version", version).text())
      .add_json("security", R"([{"token":[]}])")
      .add_json("components", R"({"securitySchemes":{"token":{"type":"http","scheme":"bearer"}}})")
      .add_json("paths", paths.text())
      .text();
}

}  // namespace fathom::serve
