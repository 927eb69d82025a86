// SPDX-License-Identifier: Apache-2.0
#include "serve/bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "engine/error.hpp"
#include "mapping/window_choice.hpp"
#include "serve/live_scores.hpp"

namespace fathom::serve {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& words) { throw Error(ErrorCode::bad_argument, words); }

/// An object whose members are all among these.
Json object_from(const Json& json, std::initializer_list<std::string_view> names) {
  if (!json.is_object()) refuse("the body is no JSON object");
  for (const auto& [key, value] : json.items()) {
    if (std::ranges::find(names, key) != names.end()) continue;
    refuse(names.size() == 0
               ? fmt::format("\"{}\" is not known; this takes nothing", key)
               : fmt::format("\"{}\" is not known; this takes {}", key, fmt::join(names, ", ")));
  }
  return json;
}

Json object_from(std::string_view body, std::initializer_list<std::string_view> names) {
  if (body.empty()) return Json::object();
  return object_from(Json::parse(body, nullptr, false), names);
}

std::optional<double> number_of(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || found->is_null()) return std::nullopt;
  if (!found->is_number() || !std::isfinite(found->get<double>()))
    refuse(fmt::format("\"{}\" is no number", name));
  return found->get<double>();
}

int whole_of(const Json& object, const char* name, int fallback) {
  const std::optional<double> number = number_of(object, name);
  if (!number) return fallback;
  constexpr double kMost = 1e9;
  if (*number != std::floor(*number) || std::abs(*number) > kMost)
    refuse(fmt::format("\"{}\" is no whole number", name));
  return static_cast<int>(*number);
}

int needed_whole_of(const Json& object, const char* name) {
  if (!object.contains(name)) refuse(fmt::format("\"{}\" is missing", name));
  return whole_of(object, name, 0);
}

std::optional<std::string> text_of(const Json& object, const char* name) {
  constexpr std::size_t kLongest = 256;
  const auto found = object.find(name);
  if (found == object.end() || found->is_null()) return std::nullopt;
  if (!found->is_string() || found->get_ref<const std::string&>().size() > kLongest)
    refuse(fmt::format("\"{}\" is no text of {} characters at most", name, kLongest));
  return found->get<std::string>();
}

Window window_from(const Json& json) {
  const Json object = object_from(json, {"x", "y", "n"});
  return {needed_whole_of(object, "x"), needed_whole_of(object, "y"), needed_whole_of(object, "n")};
}

void read_travel(const Json& object, Order& order) {
  order.from = number_of(object, "from");
  order.to = number_of(object, "to");
  order.step = number_of(object, "step");
}

Json object_for(Activity kind, std::string_view body) {
  switch (kind) {
    case Activity::aim:
      return object_from(body, {"window", "from", "to", "calibration"});
    case Activity::focus:
      return object_from(body, {"from", "to"});
    case Activity::sweep:
    case Activity::depth:
      return object_from(body, {"from", "to", "step"});
    case Activity::range:
      return object_from(body, {"calibration"});
    case Activity::calibrate:
      return object_from(body, {"model", "name"});
    case Activity::capture:
      return object_from(body, {"frames", "from", "to", "step"});
    case Activity::live:
    case Activity::stopping:
      break;
  }
  refuse("nothing that can be measured");
}

}  // namespace

std::vector<Window> windows_from(std::string_view body) {
  const Json object = object_from(body, {"windows"});
  if (!object.contains("windows") || !object["windows"].is_array())
    refuse("\"windows\" is no list of windows");
  const Json& list = object["windows"];
  if (list.empty() || list.size() > LiveScores::kMost)
    refuse(fmt::format("there may be 1 to {} windows", LiveScores::kMost));
  std::vector<Window> windows;
  for (const Json& one : list) windows.push_back(window_from(one));
  return windows;
}

LensWish lens_wish_from(std::string_view body) {
  const Json object = object_from(body, {"position", "by"});
  const LensWish wish{number_of(object, "position"), number_of(object, "by")};
  if (wish.position.has_value() == wish.by.has_value())
    refuse("say where to, as \"position\" or \"by\"");
  return wish;
}

MethodWish method_wish_from(std::string_view body) {
  const Json object = object_from(body, {"metric", "search"});
  MethodWish wish{text_of(object, "metric"), text_of(object, "search")};
  if (!wish.metric && !wish.search) refuse("name a \"metric\" or a \"search\"");
  return wish;
}

Order order_from(Activity kind, std::string_view body) {
  const Json object = object_for(kind, body);
  Order order;
  order.kind = kind;
  read_travel(object, order);
  order.frames = whole_of(object, "frames", 1);
  order.calibration = text_of(object, "calibration").value_or("");
  order.window = text_of(object, "window").value_or("auto");
  if (!mapping::window_wish(order.window)) refuse("\"window\" is auto or nearest");
  order.model = text_of(object, "model").value_or("inverse");
  order.name = text_of(object, "name").value_or("");
  if (kind == Activity::range && order.calibration.empty())
    refuse("name a \"calibration\"; state lists them");
  if (order.step && !(*order.step > 0)) refuse("\"step\" goes nowhere; it is a number above 0");
  return order;
}

NextStep next_step_from(std::string_view body) {
  const NextStep step{number_of(object_from(body, {"distance"}), "distance")};
  if (!step.distance_mm || !(*step.distance_mm > 0))
    refuse("\"distance\" is no number of millimetres above 0");
  return step;
}

double distance_from(std::string_view body) {
  const auto distance_mm = number_of(object_from(body, {"distance"}), "distance");
  if (!distance_mm) refuse("\"distance\" is missing");
  return *distance_mm;
}

std::optional<double> move_from(std::string_view body) {
  const Json object = object_from(body, {"position", "home"});
  const std::optional<double> position = number_of(object, "position");
  const bool is_home = object.contains("home") && object["home"] == true;
  if (position.has_value() == is_home) refuse("say where to, as \"position\", or \"home\": true");
  return position;
}

std::string action_from(std::string_view body) {
  const std::string action = text_of(object_from(body, {"action"}), "action").value_or("");
  constexpr std::string_view kActions[] = {"ask", "take", "give", "refuse"};
  if (std::ranges::find(kActions, action) == std::end(kActions))
    refuse("\"action\" is one of ask, take, give, refuse");
  return action;
}

void nothing_from(std::string_view body) { object_from(body, {}); }

double number_from(std::string_view name, std::string_view text, double fallback, double lowest,
                   double highest) {
  if (text.empty()) return fallback;
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() ||
      !(value >= lowest && value <= highest))
    refuse(fmt::format("{} is a number from {:g} to {:g}", name, lowest, highest));
  return value;
}

}  // namespace fathom::serve
