// SPDX-License-Identifier: Apache-2.0
// The record file: names on both sides of one page, so that writing and reading cannot drift apart.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/error.hpp"
#include "ranging/record.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fathom-record";
constexpr int kVersion = 1;

Json to_json(const Optics& optics) {
  return {{"focal_mm", optics.focal_mm},
          {"f_number", optics.f_number},
          {"circle_mm", optics.circle_mm}};
}

Optics optics_from(const Json& json) {
  const Optics optics{json.at("focal_mm"), json.at("f_number"), json.at("circle_mm")};
  optics::require_valid(optics);
  return optics;
}

Json to_json(const LensInfo& lens) {
  Json json = {{"description", lens.description}, {"unit", lens.unit},
               {"lowest", lens.lowest},           {"highest", lens.highest},
               {"resolution", lens.resolution},   {"coarse_spacing", lens.coarse_spacing}};
  if (!lens.stops.empty()) json["stops"] = lens.stops;
  if (lens.optics) json["optics"] = to_json(*lens.optics);
  return json;
}

LensInfo lens_from(const Json& json) {
  LensInfo lens{json.at("description"),
                json.at("unit"),
                json.at("lowest"),
                json.at("highest"),
                json.at("resolution"),
                json.at("coarse_spacing"),
                json.value("stops", std::vector<double>())};
  if (json.contains("optics")) lens.optics = optics_from(json.at("optics"));
  return lens;
}

Json to_json(const RecordSetup& setup) {
  return {{"verb", setup.verb},
          {"command", setup.command},
          {"created", setup.created},
          {"rig", setup.rig},
          {"camera", setup.camera},
          {"lens", to_json(setup.lens)},
          {"metric", setup.metric.text()},
          {"window", {setup.window.x, setup.window.y, setup.window.n}},
          {"backend", setup.backend},
          {"backend_reason", setup.backend_reason},
          {"average", setup.average}};
}

RecordSetup setup_from(const Json& json) {
  const Json& window = json.at("window");
  RecordSetup setup;
  setup.verb = json.at("verb");
  setup.command = json.at("command");
  setup.created = json.at("created");
  setup.rig = json.at("rig");
  setup.camera = json.at("camera");
  setup.lens = lens_from(json.at("lens"));
  setup.metric = MetricSpec::parse(json.at("metric").get<std::string>());
  setup.window = {window.at(0), window.at(1), window.at(2)};
  setup.backend = json.at("backend");
  setup.backend_reason = json.at("backend_reason");
  setup.average = json.at("average");
  return setup;
}

Json to_json(const FocusLimits& limits) {
  Json json = {{"from", limits.from},
               {"to", limits.to},
               {"coarse", limits.coarse},
               {"tolerance", limits.tolerance}};
  if (limits.bracket) {
    json["bracket"] = {limits.bracket->low, limits.bracket->inner, limits.bracket->high};
  }
  return json;
}

FocusLimits limits_from(const Json& json) {
  FocusLimits limits{json.at("from"), json.at("to"), json.at("coarse").get<std::vector<double>>(),
                     json.at("tolerance"), std::nullopt};
  if (json.contains("bracket")) {
    const Json& bracket = json.at("bracket");
    limits.bracket = Bracket{bracket.at(0), bracket.at(1), bracket.at(2)};
  }
  return limits;
}

Json to_json(const Measurement& m, int loop) {
  Json json = {{"loop", loop},
               {"position", m.position},
               {"score", m.score},
               {"settled_ns", m.settled_ns},
               {"exposure_start_ns", m.exposure.start_ns},
               {"exposure_end_ns", m.exposure.end_ns}};
  if (!m.note.empty()) json["note"] = m.note;
  return json;
}

Measurement measurement_from(const Json& json) {
  return {json.at("position"),
          json.at("score"),
          json.at("settled_ns"),
          {json.at("exposure_start_ns"), json.at("exposure_end_ns")},
          json.value("note", std::string())};
}

Json to_json(const Focus& focus) {
  return {{"result", to_string(focus.result())},
          {"position", focus.position},
          {"score", focus.score},
          {"contrast", focus.verdict.contrast},
          {"rise", focus.verdict.rise},
          {"needed_rise", focus.verdict.needed_rise},
          {"reason", focus.verdict.reason}};
}

FocusResult result_from(const std::string& name) {
  for (const auto result : {FocusResult::focused, FocusResult::no_focus, FocusResult::at_limit}) {
    if (name == to_string(result)) return result;
  }
  throw Error(ErrorCode::bad_data, fmt::format("no focus result \"{}\"", name));
}

Focus focus_from(const Json& json, std::vector<Evaluation> evaluations) {
  return {{result_from(json.at("result")), json.at("contrast"), json.at("rise"),
           json.at("needed_rise"), json.at("reason")},
          json.at("position"),
          json.at("score"),
          std::move(evaluations)};
}

Json to_json(const RecordRun& run) {
  Json json = Json::object();
  if (run.target_mm) json["target_mm"] = *run.target_mm;
  if (run.limits) json["search"] = to_json(*run.limits);
  json["repeat_scatter"] = run.repeat_scatter;
  json["evaluations"] = Json::array();
  int loop = 0;
  for (const Measurement& m : run.measurements) json["evaluations"].push_back(to_json(m, ++loop));
  if (run.focus) json["focus"] = to_json(*run.focus);
  return json;
}

RecordRun run_from(const Json& json) {
  RecordRun run;
  if (json.contains("target_mm")) run.target_mm = json.at("target_mm").get<double>();
  if (json.contains("search")) run.limits = limits_from(json.at("search"));
  run.repeat_scatter = json.at("repeat_scatter");
  for (const Json& m : json.at("evaluations")) run.measurements.push_back(measurement_from(m));
  if (json.contains("focus")) run.focus = focus_from(json.at("focus"), run.evaluations());
  return run;
}

Record record_from(const Json& json, std::string_view name) {
  if (json.at("format") != kFormat || json.at("version") != kVersion) {
    throw Error(ErrorCode::bad_data, fmt::format("not a record of version {}", kVersion));
  }
  Record record;
  record.setup = setup_from(json.at("setup"));
  for (const Json& run : json.at("runs")) record.runs.push_back(run_from(run));
  if (json.contains("calibration")) {
    record.calibration = Calibration::parse(json.at("calibration").dump(), name);
  }
  record.extrapolate = json.at("extrapolate");
  if (json.contains("distance")) {
    record.distance = Distance{json.at("distance").at("mm"), json.at("distance").at("sigma_mm")};
  }
  record.error = json.value("error", std::string());
  return record;
}

}  // namespace

std::string Record::json() const {
  Json json = {{"format", kFormat}, {"version", kVersion}, {"setup", to_json(setup)}};
  json["runs"] = Json::array();
  for (const RecordRun& run : runs) json["runs"].push_back(to_json(run));
  if (calibration) json["calibration"] = Json::parse(calibration->json());
  json["extrapolate"] = extrapolate;
  if (distance) json["distance"] = {{"mm", distance->mm}, {"sigma_mm", distance->sigma_mm}};
  if (!error.empty()) json["error"] = error;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Record Record::parse(std::string_view text, std::string_view name) {
  try {
    return record_from(Json::parse(text), name);
  } catch (const Json::exception&) {
    throw Error(ErrorCode::bad_data,
                fmt::format("{} is damaged or no record; fathom focus -o FILE makes one", name));
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{} is no record: {}", name, error.what()));
  }
}

}  // namespace fathom
