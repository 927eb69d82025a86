// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace fathom::http {
namespace {

using Json = nlohmann::json;

constexpr int kWidest_px = 100'000;
constexpr std::int64_t kMostPixels = 1 << 28;

[[noreturn]] void refuse(std::string_view what) {
  throw Error(ErrorCode::bad_data, fmt::format("the service says what no rig is: {}", what));
}

/// What `read` makes of a text; whatever is missing or of another kind is refused.
template <typename Read>
auto read_json(std::string_view text, const Read& read) {
  try {
    return read(Json::parse(text));
  } catch (const Json::exception& problem) {
    refuse(problem.what());
  }
}

/// A whole number that fits; a fraction would be cut off without a word.
template <typename Number>
Number whole_of(const Json& json, const char* name) {
  const Json& value = json.at(name);
  const auto whole = value.is_number_integer() ? value.get<std::int64_t>() : 0;
  if (!value.is_number_integer() || !std::in_range<Number>(whole))
    refuse(fmt::format("\"{}\" is no whole number", name));
  return static_cast<Number>(whole);
}

template <typename Number>
std::optional<Number> optional_of(const Json& json, const char* name) {
  const Json& value = json.at(name);
  return value.is_null() ? std::nullopt : std::optional(value.get<Number>());
}

CameraFacts camera_from(const Json& json) {
  constexpr double kHour_ms = 3.6e6;
  CameraFacts facts;
  facts.description = json.at("description");
  facts.settings = {.width_px = whole_of<int>(json, "width"),
                    .height_px = whole_of<int>(json, "height"),
                    .depth = json.at("bits") == 8 ? Depth::bits8 : Depth::bits16,
                    .exposure_ms = json.at("exposure_ms")};
  facts.is_live = json.at("live");
  facts.streams = json.at("streams");
  facts.recorded_here = whole_of<int>(json, "recorded_here");
  const auto patience_ms = json.at("patience_ms").get<double>();
  const CameraSettings& own = facts.settings;
  const auto is_side = [](int side) { return side >= 1 && side <= kWidest_px; };
  if (!is_side(own.width_px) || !is_side(own.height_px) ||
      static_cast<std::int64_t>(own.width_px) * own.height_px > kMostPixels)
    refuse(fmt::format("pictures of {} x {} px", own.width_px, own.height_px));
  if (!(own.exposure_ms >= 0 && own.exposure_ms <= kHour_ms)) refuse("an exposure without end");
  if (!(patience_ms >= 0 && patience_ms <= kHour_ms)) refuse("a patience without end");
  if (facts.recorded_here < 1) refuse("no picture of a place");
  facts.patience = std::chrono::milliseconds(static_cast<std::int64_t>(patience_ms));
  return facts;
}

std::optional<Optics> optics_from(const Json& json) {
  if (json.is_null()) return std::nullopt;
  const Optics optics{.focal_mm = json.at("focal_mm"),
                      .f_number = json.at("f_number"),
                      .circle_mm = json.at("circle_mm")};
  const auto is_length = [](double value) { return std::isfinite(value) && value > 0; };
  if (!is_length(optics.focal_mm) || !is_length(optics.f_number) || !is_length(optics.circle_mm))
    refuse("optics of no lens");
  return optics;
}

void require_travel(const LensInfo& lens) {
  const double travel = lens.highest - lens.lowest;
  if (!(std::isfinite(travel) && travel > 0)) refuse("a lens without a travel");
  if (!(lens.resolution > 0 && lens.resolution <= travel)) refuse("a lens without a step");
  if (!(lens.coarse_spacing >= 0 && lens.coarse_spacing <= travel)) refuse("a coarse spacing");
  const bool is_rising =
      std::ranges::adjacent_find(lens.stops, std::greater_equal<>()) == lens.stops.end();
  const bool is_within = lens.stops.empty() ||
                         (lens.stops.front() == lens.lowest && lens.stops.back() == lens.highest);
  if (!is_rising || !is_within) refuse("stops that are not in order");
  if (!lens.stop_names.empty() && lens.stop_names.size() != lens.stops.size())
    refuse("other names than stops");
  if (lens.blur_px_per_unit &&
      !(std::isfinite(*lens.blur_px_per_unit) && *lens.blur_px_per_unit > 0))
    refuse("a blur that does not grow");
}

LensInfo lens_from(const Json& json) {
  LensInfo lens{.description = json.at("description"),
                .unit = json.at("unit"),
                .lowest = json.at("min"),
                .highest = json.at("max"),
                .resolution = json.at("step"),
                .coarse_spacing = json.at("coarse"),
                .stops = json.at("stops"),
                .optics = optics_from(json.at("optics")),
                .blur_px_per_unit = optional_of<double>(json, "blur_px_per_unit"),
                .stop_names = json.at("stop_names")};
  require_travel(lens);
  return lens;
}

/// The pixels behind the head that a frame of this shape has.
std::string_view pixels_of(std::string_view pgm, const CameraSettings& shape) {
  const bool is_deep = shape.depth == Depth::bits16;
  const std::string head =
      fmt::format("P5\n{} {}\n{}\n", shape.width_px, shape.height_px, is_deep ? 65535 : 255);
  const std::size_t bytes =
      static_cast<std::size_t>(shape.width_px) * shape.height_px * bytes_per_pixel(shape.depth);
  if (!pgm.starts_with(head) || pgm.size() != head.size() + bytes)
    refuse("a picture of another shape than its camera has");
  return pgm.substr(head.size());
}

}  // namespace

Facts facts_from(std::string_view json) {
  return read_json(json, [](const Json& rig) {
    return Facts{.camera = camera_from(rig.at("camera")),
                 .lens = lens_from(rig.at("lens")),
                 .has_stage = rig.at("stage")};
  });
}

Moved moved_from(std::string_view json) {
  return read_json(json, [](const Json& move) {
    Moved moved;
    moved.is_done = move.at("done");
    if (const Json& error = move.at("error"); !error.is_null()) {
      moved.failure.emplace(code_named(error.at("code").get<std::string>()),
                            error.at("message").get<std::string>());
    } else if (const Json& arrival = move.at("arrival"); moved.is_done) {
      moved.arrival = {.position = arrival.at("position"),
                       .started_ns = whole_of<std::int64_t>(arrival, "started_ns"),
                       .stopped_ns = whole_of<std::int64_t>(arrival, "stopped_ns"),
                       .settled_ns = whole_of<std::int64_t>(arrival, "settled_ns"),
                       .note = arrival.at("note")};
      moved.recorded_here = std::max(1, whole_of<int>(arrival, "recorded_here"));
    }
    return moved;
  });
}

double number_from(std::string_view json, const char* name) {
  return read_json(json, [&](const Json& answer) { return answer.at(name).get<double>(); });
}

int whole_from(std::string_view json, const char* name) {
  return read_json(json, [&](const Json& answer) { return whole_of<int>(answer, name); });
}

Refusal refusal_from(std::string_view json) {
  const Json answer = Json::parse(json, nullptr, false);
  if (!answer.is_object() || !answer.contains("error") || !answer["error"].is_object()) return {};
  const Json& error = answer["error"];
  const auto text = [&](const char* name) {
    const auto found = error.find(name);
    return found != error.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  return {.code = text("code"), .message = text("message")};
}

ErrorCode code_named(std::string_view name) {
  for (const ErrorCode code :
       {ErrorCode::bad_argument, ErrorCode::out_of_bounds, ErrorCode::bad_data, ErrorCode::io,
        ErrorCode::unavailable, ErrorCode::unsupported, ErrorCode::device_lost,
        ErrorCode::out_of_memory, ErrorCode::timeout, ErrorCode::cancelled}) {
    if (name == to_string(code)) return code;
  }
  return ErrorCode::bad_data;
}

Frame frame_from(std::string_view pgm, const CameraSettings& shape) {
  const std::string_view pixels = pixels_of(pgm, shape);
  if (shape.depth == Depth::bits8)
    return {shape.width_px, shape.height_px,
            std::vector<std::uint8_t>(pixels.begin(), pixels.end())};
  std::vector<std::uint16_t> deep(pixels.size() / 2);
  for (std::size_t i = 0; i < deep.size(); ++i) {
    const auto high = static_cast<unsigned char>(pixels[2 * i]);
    const auto low = static_cast<unsigned char>(pixels[2 * i + 1]);
    deep[i] = static_cast<std::uint16_t>(high << 8 | low);
  }
  return {shape.width_px, shape.height_px, std::move(deep)};
}

}  // namespace fathom::http
