// SPDX-License-Identifier: Apache-2.0
#include "session/focus_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/error.hpp"
#include "engine/json.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

/// The value of an enumeration that has this name.
template <class Value, std::size_t Count>
Value named(const Value (&values)[Count], const std::string& name) {
  for (const Value value : values) {
    if (name == to_string(value)) return value;
  }
  throw Error(ErrorCode::bad_data, fmt::format("nothing is called \"{}\"", name));
}

constexpr Transform kTransforms[] = {Transform::fft, Transform::walsh_paley,
                                     Transform::walsh_sequency, Transform::walsh_hadamard,
                                     Transform::dct};
constexpr PeakShape kShapes[] = {PeakShape::none, PeakShape::parabola, PeakShape::gaussian,
                                 PeakShape::lorentzian};
constexpr FocusResult kResults[] = {FocusResult::focused, FocusResult::no_focus,
                                    FocusResult::at_limit, FocusResult::ambiguous};

Json to_json(const Peak& peak) {
  return {{"position", peak.position},     {"sigma", peak.sigma},
          {"score", peak.score},           {"shape", to_string(peak.shape)},
          {"half_width", peak.half_width}, {"r_squared", peak.r_squared},
          {"points", peak.points},         {"parameters", peak.parameters}};
}

Peak peak_from(const Json& json) {
  return {.shape = named(kShapes, json.at("shape")),
          .position = json.at("position"),
          .sigma = json.at("sigma"),
          .score = json.at("score"),
          .half_width = json.at("half_width"),
          .r_squared = json.at("r_squared"),
          .points = whole_from<int>(json.at("points")),
          .parameters = json.at("parameters")};
}

Json to_json(const Reason& reason) {
  return {{"why", to_string(reason.why)},
          {"position", reason.position},
          {"r_squared", reason.r_squared},
          {"confidence", reason.confidence},
          {"second_position", reason.second_position},
          {"second_part", reason.second_part},
          {"contrast", reason.contrast},
          {"is_live", reason.is_live},
          {"at_lens_end", reason.at_lens_end},
          {"whole_travel", reason.whole_travel},
          {"largest_window", reason.largest_window},
          {"saturated", reason.saturated},
          {"light_left", reason.light_left},
          {"transform", to_string(reason.transform)},
          {"evaluations", reason.evaluations},
          {"dead", reason.dead}};
}

/// Version 2 kept words, which nothing can be learned from.
Reason reason_from(const Json& json) {
  if (json.is_string()) return {};
  return {.why = named(kWhys, json.at("why")),
          .position = json.at("position"),
          .r_squared = json.at("r_squared"),
          .confidence = json.at("confidence"),
          .second_position = json.at("second_position"),
          .second_part = json.at("second_part"),
          .contrast = json.value("contrast", 0.0),
          .is_live = json.value("is_live", false),
          .at_lens_end = json.value("at_lens_end", false),
          .whole_travel = json.value("whole_travel", false),
          .largest_window = json.value("largest_window", false),
          .saturated = json.value("saturated", 0.0),
          .light_left = json.value("light_left", 1.0),
          .transform = named(kTransforms, json.value("transform", "fft")),
          .evaluations = whole_from<int>(json.at("evaluations")),
          .dead = whole_from<int>(json.at("dead"))};
}

Json to_json(const SpectralFit& fit) {
  return {{"side", fit.side},
          {"pictures", fit.pictures},
          {"position", fit.position},
          {"sigma", fit.sigma},
          {"evidence", fit.evidence},
          {"misfit", fit.misfit},
          {"second_position", fit.second_position},
          {"second_worse", fit.second_worse}};
}

SpectralFit spectral_from(const Json& json) {
  return {.side = whole_from<int>(json.at("side")),
          .pictures = whole_from<int>(json.at("pictures")),
          .position = json.at("position"),
          .sigma = json.at("sigma"),
          .evidence = json.at("evidence"),
          .misfit = json.at("misfit"),
          .second_position = json.at("second_position"),
          .second_worse = json.at("second_worse")};
}

Verdict verdict_from(const Json& json) {
  return {.result = named(kResults, json.at("result")),
          .rise = {json.at("contrast"), json.at("rise"), json.at("needed_rise")},
          .confidence = json.at("confidence"),
          .reason = reason_from(json.at("reason"))};
}

Json to_json(const std::vector<Evaluation>& evaluations) {
  Json list = Json::array();
  for (const Evaluation& e : evaluations)
    list.push_back({{"loop", e.loop}, {"position", e.position}, {"score", e.score}});
  return list;
}

std::vector<double> positions_of(const std::vector<Peak>& peaks) {
  std::vector<double> positions;
  for (const Peak& peak : peaks) positions.push_back(peak.position);
  return positions;
}

/// What programs seldom ask for, and a rerun compares.
void add_rest(Json& json, const Focus& focus) {
  const Rise& rise = focus.verdict.rise;
  json["half_width"] = focus.peak.half_width;
  json["points"] = focus.peak.points;
  json["parameters"] = focus.peak.parameters;
  json["contrast"] = rise.contrast;
  json["rise"] = rise.rise;
  json["needed_rise"] = rise.needed;
  json["reason"] = to_json(focus.verdict.reason);
  json["floor"] = focus.floor;
  json["peaks"] = Json::array();
  for (const Peak& lobe : focus.lobes) json["peaks"].push_back(to_json(lobe));
  json["parts"] = Json::array();
  for (const Peak& part : focus.depths.parts)
    json["parts"].push_back({{"position", part.position}, {"sigma", part.sigma}});
  json["spread"] = focus.depths.spread;
  if (focus.spectral) json["spectral"] = to_json(*focus.spectral);
  if (focus.spectral_end) json["spectral_end"] = to_string(*focus.spectral_end);
  json["trace"] = to_json(focus.evaluations);
  json["second_looks"] = to_json(focus.second_looks);
  json["background"] = to_json(focus.background);
}

std::vector<Evaluation> evaluations_from(const Json& json) {
  std::vector<Evaluation> evaluations;
  for (const Json& e : json)
    evaluations.push_back({whole_from<int>(e.at("loop")), e.at("position"), e.at("score")});
  return evaluations;
}

/// Whole numbers of 53 bits without ".0".
void shorten(Json& json) {
  constexpr double kExact = 9007199254740992;
  if (json.is_structured()) {
    for (Json& member : json) shorten(member);
  } else if (json.is_number_float()) {
    const double value = json.get<double>();
    if (value == std::floor(value) && std::abs(value) < kExact)
      json = static_cast<std::int64_t>(value);
  }
}

}  // namespace

Json focus_to_json(const Focus& focus, const LensInfo& lens) {
  const Peak& peak = focus.peak;
  Json json = {{"result", to_string(focus.result())},
               {"position", peak.position},
               {"nearest", nearest_position(lens, peak.position)},
               {"sigma", peak.sigma},
               {"score", peak.score},
               {"confidence", focus.verdict.confidence},
               {"shape", to_string(peak.shape)},
               {"r_squared", peak.r_squared},
               {"lobes", positions_of(focus.lobes)},
               {"evaluations", focus.evaluations.size()}};
  if (std::string name = nearest_name(lens, peak.position); !name.empty())
    json["nearest_file"] = std::move(name);
  add_rest(json, focus);
  return json;
}

Focus focus_from_json(const Json& json) {
  Focus focus;
  focus.verdict = verdict_from(json);
  focus.peak = peak_from(json);
  for (const Json& lobe : json.at("peaks")) focus.lobes.push_back(peak_from(lobe));
  focus.evaluations = evaluations_from(json.at("trace"));
  if (json.contains("second_looks")) focus.second_looks = evaluations_from(json.at("second_looks"));
  focus.background = evaluations_from(json.at("background"));
  focus.floor = json.at("floor");
  if (json.contains("spectral")) focus.spectral = spectral_from(json.at("spectral"));
  if (json.contains("spectral_end"))
    focus.spectral_end = named(kSpectralEnds, json.at("spectral_end"));
  return focus;
}

Focus focus_from_version_2(const Json& json, std::vector<Evaluation> evaluations) {
  Focus focus;
  focus.verdict = verdict_from(json);
  focus.peak = peak_from(json.at("peak"));
  for (const Json& lobe : json.at("lobes")) focus.lobes.push_back(peak_from(lobe));
  focus.evaluations = std::move(evaluations);
  return focus;
}

std::string focus_members(const Focus& focus, const LensInfo& lens) {
  Json json = focus_to_json(focus, lens);
  shorten(json);
  const std::string object = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return object.substr(1, object.size() - 2);
}

}  // namespace fathom
