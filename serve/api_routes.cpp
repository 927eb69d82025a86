// SPDX-License-Identifier: Apache-2.0
// The table of what can be asked for.
#include <fmt/format.h>

#include <utility>

#include "focus/searches.hpp"
#include "pictures/decoder.hpp"
#include "pictures/raster.hpp"
#include "serve/api.hpp"
#include "serve/bodies.hpp"
#include "serve/frame_answer.hpp"
#include "session/json_line.hpp"
#include "session/run_store.hpp"

namespace fathom::serve {
namespace {

using httplib::Request;
using httplib::Response;

constexpr const char* kJson = "application/json";

/// Metrics that a page offers; any that MetricSpec::parse takes may be set.
constexpr std::pair<const char*, const char*> kMetrics[] = {
    {"walsh-sequency", "Walsh, by sequency: sharp and quick; light does not change it"},
    {"fft:hann:band=0.05-0.25", "Fourier, tapered, the middle frequencies: little noise"},
    {"fft", "Fourier, the whole spectrum, as in the thesis"},
    {"fft:power", "the same of the power: a narrower peak"},
    {"walsh-paley", "Walsh in Paley's order, as in the thesis"},
    {"walsh-hadamard", "Walsh in Hadamard's order"},
    {"dct", "cosines: like Fourier without the window's edges"},
    {"dct:entropy", "entropy of the cosines: for little contrast"}};

std::string list_item(std::string_view name, std::string_view line) {
  return JsonLine().add("name", name).add("line", line).text();
}

std::string metric_list() {
  std::string list;
  for (const auto& [name, line] : kMetrics)
    list += (list.empty() ? "" : ",") + list_item(name, line);
  return "[" + list + "]";
}

std::string search_list() {
  std::string list;
  for (const Search& search : searches()) {
    const std::string line = *search.help != '\0' ? search.help : search.name;
    list += (list.empty() ? "" : ",") + list_item(search.name, line);
  }
  return "[" + list + "]";
}

std::vector<Field> travel_fields() {
  return {{"from", "number", "First lens position; the lens's lowest"},
          {"to", "number", "Last lens position; the lens's highest"},
          {"step", "number", "Distance between positions; some hundred, or all that there are"}};
}

void set_json(Response& response, const std::string& text) { response.set_content(text, kJson); }

}  // namespace

/// Looks at the newest frame that was made while somebody watched.
void Api::send_frame(const Request& request, Response& response) {
  const std::string format = request.get_param_value("format");
  if (!format.empty() && format != "png" && format != "pgm")
    throw Error(ErrorCode::bad_argument, "format is png or pgm");
  const auto newest = publisher_.pictures.newest();
  publisher_.pictures.add_watcher(1);
  const auto picture =
      publisher_.pictures.next(newest ? newest->number() : 0, std::chrono::seconds(10));
  publisher_.pictures.add_watcher(-1);
  if (!picture) throw Error(ErrorCode::timeout, "no picture came within 10 s");
  set_frame_headers(response, picture->frame().exposure, picture->position);
  response.set_header("X-Fathom-Settled", picture->is_settled ? "1" : "0");
  if (format == "pgm")
    return response.set_content(pictures::encode_pgm(picture->frame()), "image/x-portable-graymap");
  response.set_content(encode_png(raster_of(picture->frame()), PngEffort::fast), "image/png");
}

void Api::add_looks() {
  add({.method = "GET",
       .path = "state",
       .help = "How things stand: camera, lens, windows, what is measured, who drives",
       .gives = kJson,
       .fields = {{"client", "string", "Name of the client that asks"}},
       .handle = [this](const Request& request, Response& response) {
         set_json(response, state_json(client_of(request)));
       }});
  add({.method = "GET",
       .path = "metrics",
       .help = "Metrics with a line on each",
       .gives = kJson,
       .handle = [](const Request&, Response& response) { set_json(response, metric_list()); }});
  add({.method = "GET",
       .path = "searches",
       .help = "Searches with a line on each",
       .gives = kJson,
       .handle = [](const Request&, Response& response) { set_json(response, search_list()); }});
  add({.method = "GET",
       .path = "frame",
       .help = "The next frame, as it is",
       .gives = "image/png",
       .fields = {{"format", "string", "png or pgm"}},
       .handle = [this](const Request& request, Response& response) {
         send_frame(request, response);
       }});
  add({.method = "GET",
       .path = "stream.mjpg",
       .help = "The picture, one JPEG after the other",
       .gives = "multipart/x-mixed-replace",
       .fields = {{"fps", "number", "Pictures a second at most, 0.1 to 100"},
                  {"width", "integer", "Pixels across at most"},
                  {"bare", "integer", "1: no stamp, position and length; browsers show it sooner"}},
       .handle = [this](const Request& request, Response& response) {
         stream_pictures(request, response);
       }});
  add({.method = "GET",
       .path = "events",
       .help = "Server-sent events: state, frame, score, spectrum, began, evaluated, warning, "
               "found, ended, map, drive",
       .gives = "text/event-stream",
       .fields = {{"client", "string", "Name of the client that asks"}},
       .handle = [this](const Request& request, Response& response) {
         stream_events(request, response);
       }});
}

void Api::add_commands() {
  const auto done = [](Response& response) { set_json(response, "{}"); };
  add({.method = "POST",
       .path = "windows",
       .help = "What is scored; the first window is measured with",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"windows", "array", "Objects of x, y and n, px"}},
       .handle = [this, done](const Request& request, Response& response) {
         rig_.set_windows(windows_from(request.body));
         done(response);
       }});
  add({.method = "POST",
       .path = "lens",
       .help = "Sends the lens to a position, or by so much",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"position", "number", "Where to"}, {"by", "number", "How far"}},
       .handle = [this, done](const Request& request, Response& response) {
         const LensWish wish = lens_wish_from(request.body);
         wish.position ? rig_.move_lens(*wish.position) : rig_.move_lens_by(*wish.by);
         done(response);
       }});
  add({.method = "POST",
       .path = "settings",
       .help = "Chooses metric and search",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"metric", "string", "As fathom's --metric"},
                  {"search", "string", "As fathom's --search"}},
       .handle = [this, done](const Request& request, Response& response) {
         const MethodWish wish = method_wish_from(request.body);
         rig_.set_methods(wish.metric, wish.search);
         done(response);
       }});
  add({.method = "POST",
       .path = "stop",
       .help = "Ends what is measured or moved; the lens goes back. Anybody may",
       .gives = kJson,
       .right = Right::stop,
       .handle = [this, done](const Request& request, Response& response) {
         nothing_from(request.body);
         rig_.stop();
         done(response);
       }});
  add({.method = "POST",
       .path = "drive",
       .help = "Who drives: ask, take, give, refuse. Anybody may ask",
       .gives = kJson,
       .right = Right::stop,
       .fields = {{"action", "string", "ask, take, give or refuse"}},
       .handle = [this](const Request& request, Response& response) {
         change_drive(client_of(request), action_from(request.body));
         set_json(response, drive_json(client_of(request)));
       }});
}

void Api::add_order(Activity kind, const char* help, std::vector<Field> fields) {
  add({.method = "POST",
       .path = to_string(kind),
       .help = help,
       .gives = kJson,
       .right = Right::driver,
       .fields = std::move(fields),
       .handle = [this, kind](const Request& request, Response& response) {
         Order order = order_from(kind, request.body);
         if (order.name.empty()) order.name = utc_for_name();
         const std::string name = order.name;
         const int id = rig_.start(std::move(order));
         response.status = 202;
         set_json(response,
                  JsonLine().add("id", id).add("kind", to_string(kind)).add("name", name).text());
       }});
}

void Api::add_measurements() {
  std::vector<Field> ends = travel_fields();
  ends.pop_back();
  std::vector<Field> aim = ends;
  aim.insert(aim.begin(), {"window", "string",
                           "auto: where most texture of one depth is; nearest: on the nearest "
                           "surface"});
  aim.push_back({"calibration", "string", "Name of one that says which way is near"});
  add_order(Activity::aim, "Looks round with the lens, and puts window 1 where it finds", aim);
  add_order(Activity::focus, "Searches for the focus, and leaves the lens there", ends);
  add_order(Activity::sweep, "Scores every position of a travel", travel_fields());
  add_order(Activity::range, "Measures how far away the target is",
            {{"calibration", "string", "Name of one, as state lists them"}});
  add_order(
      Activity::calibrate, "Begins a calibration; then calibrate/next at each distance",
      {{"model", "string", "Curve to fit, or auto"}, {"name", "string", "What to keep it as"}});
  add_order(Activity::depth, "Maps the depth of every pixel", travel_fields());
  std::vector<Field> pictures = travel_fields();
  pictures.push_back({"frames", "integer", "How many where the lens stands, without a travel"});
  add_order(Activity::capture, "Keeps pictures in a folder that replay: reads", pictures);
  const auto done = [](Response& response) { set_json(response, "{}"); };
  add({.method = "POST",
       .path = "calibrate/next",
       .help = "The target stands at this distance now: focuses on it",
       .gives = kJson,
       .right = Right::driver,
       .fields = {{"distance", "number", "mm"}},
       .handle = [this, done](const Request& request, Response& response) {
         rig_.next_step(next_step_from(request.body));
         done(response);
       }});
  add({.method = "POST",
       .path = "calibrate/done",
       .help = "There are no more distances: fits the curve and keeps it",
       .gives = kJson,
       .right = Right::driver,
       .handle = [this, done](const Request& request, Response& response) {
         nothing_from(request.body);
         rig_.next_step({});
         done(response);
       }});
}

void Api::add_runs() {
  const auto or_none = [](Response& response, const std::optional<std::string>& text) {
    if (!text) return set_error(response, 404, "no_run", "there is no run of this name");
    set_json(response, *text);
  };
  add({.method = "GET",
       .path = "runs",
       .help = "The newest runs, the newest first",
       .gives = kJson,
       .handle = [this](const Request&, Response& response) {
         set_json(response, shelf_.list());
       }});
  add({.method = "GET",
       .path = "runs/{id}",
       .help = "A run as it was kept",
       .gives = kJson,
       .handle = [this, or_none](const Request& request, Response& response) {
         or_none(response, shelf_.file(request.matches[1]));
       }});
  add({.method = "GET",
       .path = "runs/{id}/file",
       .help = "The same, to be kept as a file",
       .gives = kJson,
       .handle = [this, or_none](const Request& request, Response& response) {
         const std::string id = request.matches[1];
         or_none(response, shelf_.file(id));
         if (response.status == 200)
           response.set_header("Content-Disposition", "attachment; filename=\"" + id + ".json\"");
       }});
  add({.method = "POST",
       .path = "runs/{id}/rerun",
       .help = "Computes a run again from its scores",
       .gives = kJson,
       .right = Right::watch,
       .handle = [this, or_none](const Request& request, Response& response) {
         nothing_from(request.body);
         or_none(response, shelf_.rerun(request.matches[1]));
       }});
}

}  // namespace fathom::serve
