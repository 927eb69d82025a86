// SPDX-License-Identifier: Apache-2.0
// The rig for one program alone: hal/drivers/http asks for it.
#include <fmt/format.h>

#include <utility>

#include "hal/clock.hpp"
#include "pictures/decoder.hpp"
#include "serve/api.hpp"
#include "serve/bodies.hpp"
#include "serve/frame_answer.hpp"
#include "session/json_line.hpp"

namespace fathom::serve {
namespace {

using httplib::Request;
using httplib::Response;
using std::chrono::milliseconds;

constexpr const char* kJson = "application/json";
constexpr double kLongestWait_ms = 1000;

milliseconds wait_from(const Request& request, const char* name) {
  return milliseconds(
      static_cast<int>(number_from(name, request.get_param_value(name), 0, 0, kLongestWait_ms)));
}

/// What time it is here, for those who compare clocks.
void set_now(Response& response) {
  response.set_header("X-Fathom-Now-Ns", std::to_string(monotonic_now_ns()));
}

void set_json(Response& response, const std::string& text) {
  set_now(response);
  response.set_content(text, kJson);
}

std::string arrival_json(const LensMove& move) {
  return JsonLine()
      .add("position", move.arrival.position)
      .add_json("started_ns", std::to_string(move.arrival.started_ns))
      .add_json("stopped_ns", std::to_string(move.arrival.stopped_ns))
      .add_json("settled_ns", std::to_string(move.arrival.settled_ns))
      .add("note", move.arrival.note)
      .add("recorded_here", move.recorded_here)
      .text();
}

std::string move_json(const LensMove& move) {
  JsonLine line;
  line.add("id", move.id).add_json("done", move.is_done ? "true" : "false");
  const bool has_arrived = move.is_done && !move.failure;
  line.add_json("arrival", has_arrived ? arrival_json(move) : "null");
  return line
      .add_json("error", move.failure ? JsonLine()
                                            .add("code", to_string(move.failure->code()))
                                            .add("message", move.failure->what())
                                            .text()
                                      : "null")
      .text();
}

std::optional<std::pair<double, double>> place_from(const Request& request) {
  constexpr double kWidest = 100'000;
  if (!request.has_param("x") && !request.has_param("y")) return std::nullopt;
  return std::pair(number_from("x", request.get_param_value("x"), 0, 0, kWidest),
                   number_from("y", request.get_param_value("y"), 0, 0, kWidest));
}

}  // namespace

void Api::send_taken(const Request& request, Response& response) {
  constexpr int kNoContent = 204;
  const auto taken = rig_.take(wait_from(request, "timeout_ms"));
  set_now(response);
  if (!taken) {
    response.status = kNoContent;
    return;
  }
  set_frame_headers(response, taken->frame.exposure, taken->position);
  response.set_header("X-Fathom-Dropped", std::to_string(taken->counts.dropped));
  response.set_header("X-Fathom-Corrupt", std::to_string(taken->counts.corrupt));
  response.set_content(pictures::encode_pgm(taken->frame), "image/x-portable-graymap");
}

void Api::add_rig() {
  add({.method = "GET",
       .path = "rig",
       .help = "What the rig is: all that a program must know that has it as its own",
       .gives = kJson,
       .handle = [this](const Request&, Response& response) {
         set_json(response, rig_.rig_facts());
       }});
  add({.method = "GET",
       .path = "rig/clock",
       .help = "What time it is on the rig's computer (X-Fathom-Now-Ns); keeps the drive",
       .gives = kJson,
       .right = Right::driver,
       .handle = [](const Request&, Response& response) { set_json(response, "{}"); }});
  add({.method = "GET",
       .path = "rig/frame",
       .help = "The camera's next frame, taken for this client; 204 where none comes in time",
       .gives = "image/x-portable-graymap",
       .right = Right::driver,
       .fields = {{"timeout_ms", "number", "How long to wait, 0 to 1000"}},
       .handle = [this](const Request& request, Response& response) {
         send_taken(request, response);
       }});
  add({.method = "GET",
       .path = "rig/position",
       .help = "Where the lens stands",
       .gives = kJson,
       .right = Right::driver,
       .handle = [this](const Request&, Response& response) {
         set_json(response, JsonLine().add("position", rig_.lens_position()).text());
       }});
  add_rig_moves();
  add_rig_stage();
}

void Api::add_rig_moves() {
  constexpr int kAccepted = 202;
  add({.method = "POST",
       .path = "rig/move",
       .help = "Begins a move of the lens that is followed with rig/moved",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"position", "number", "Where to"}, {"home", "boolean", "To its stop instead"}},
       .handle = [this](const Request& request, Response& response) {
         const int id = rig_.begin_move(move_from(request.body));
         response.status = kAccepted;
         set_json(response, JsonLine().add("id", id).text());
       }});
  add({.method = "GET",
       .path = "rig/moved",
       .help = "How the newest move stands: done, arrival, error",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"id", "integer", "Number of the move"},
                  {"wait_ms", "number", "How long to wait for its end, 0 to 1000"}},
       .handle = [this](const Request& request, Response& response) {
         constexpr double kMost = 1e9;
         const auto id =
             static_cast<int>(number_from("id", request.get_param_value("id"), 0, 0, kMost));
         set_json(response, move_json(rig_.moved(id, wait_from(request, "wait_ms"))));
       }});
}

void Api::add_rig_stage() {
  add({.method = "GET",
       .path = "rig/stage",
       .help = "How far away the target stands, or what a place in the picture shows",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"x", "number", "px"}, {"y", "number", "px"}},
       .handle = [this](const Request& request, Response& response) {
         const double distance_mm = rig_.stage_distance(place_from(request));
         set_json(response, JsonLine().add("distance", distance_mm).text());
       }});
  add({.method = "POST",
       .path = "rig/place",
       .help = "Puts the target of a simulated rig at a distance",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"distance", "number", "mm"}},
       .handle = [this](const Request& request, Response& response) {
         rig_.place_target(distance_from(request.body));
         set_json(response, "{}");
       }});
}

}  // namespace fathom::serve
