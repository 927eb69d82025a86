// SPDX-License-Identifier: Apache-2.0
// The record file: names on both sides of one page, so that writing and reading cannot drift apart.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/error.hpp"
#include "session/run_file.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fathom-record";
constexpr int kVersion = 2;

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

Json to_json(const RunSetup& setup) {
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

RunSetup setup_from(const Json& json) {
  const Json& window = json.at("window");
  RunSetup setup;
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
  Json json = {{"method", to_string(limits.search)},
               {"peak", to_string(limits.peak)},
               {"from", limits.from},
               {"to", limits.to},
               {"tolerance", limits.tolerance},
               {"coarse", limits.coarse.positions},
               {"halvings", limits.coarse.halvings},
               {"spacing_is_guess", limits.coarse.is_guess},
               {"start", limits.start},
               {"first_step", limits.first_step}};
  if (limits.bracket) {
    json["bracket"] = {limits.bracket->low, limits.bracket->inner, limits.bracket->high};
  }
  return json;
}

FocusLimits limits_from(const Json& json) {
  FocusLimits limits;
  limits.search = parse_search_method(json.at("method").get<std::string>());
  limits.peak = parse_peak_method(json.at("peak").get<std::string>());
  limits.from = json.at("from");
  limits.to = json.at("to");
  limits.tolerance = json.at("tolerance");
  limits.coarse = {json.at("coarse").get<std::vector<double>>(), json.at("halvings"),
                   json.at("spacing_is_guess")};
  limits.start = json.at("start");
  limits.first_step = json.at("first_step");
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
               {"started_ns", m.started_ns},
               {"stopped_ns", m.stopped_ns},
               {"settled_ns", m.settled_ns},
               {"exposure_start_ns", m.exposure.start_ns},
               {"exposure_end_ns", m.exposure.end_ns},
               {"compute_ns", m.compute_ns}};
  if (m.saturated > 0) json["saturated"] = m.saturated;
  if (!m.note.empty()) json["note"] = m.note;
  return json;
}

Measurement measurement_from(const Json& json) {
  return {json.at("position"),
          json.at("score"),
          json.at("settled_ns"),
          {json.at("exposure_start_ns"), json.at("exposure_end_ns")},
          json.value("note", std::string()),
          json.at("started_ns"),
          json.at("stopped_ns"),
          json.at("compute_ns"),
          json.value("saturated", 0.0)};
}

Json to_json(const Peak& peak) {
  return {{"position", peak.position},     {"sigma", peak.sigma},
          {"score", peak.score},           {"shape", to_string(peak.shape)},
          {"half_width", peak.half_width}, {"r_squared", peak.r_squared},
          {"points", peak.points},         {"parameters", peak.parameters}};
}

/// The value of an enumeration that has this name.
template <class Value, std::size_t Count>
Value named(const Value (&values)[Count], const std::string& name) {
  for (const Value value : values) {
    if (name == to_string(value)) return value;
  }
  throw Error(ErrorCode::bad_data, fmt::format("nothing is called \"{}\"", name));
}

constexpr PeakShape kShapes[] = {PeakShape::none, PeakShape::parabola, PeakShape::gaussian,
                                 PeakShape::lorentzian};
constexpr FocusResult kResults[] = {FocusResult::focused, FocusResult::no_focus,
                                    FocusResult::at_limit, FocusResult::ambiguous};

Peak peak_from(const Json& json) {
  return {named(kShapes, json.at("shape")),
          json.at("position"),
          json.at("sigma"),
          json.at("score"),
          json.at("half_width"),
          json.at("r_squared"),
          json.at("points"),
          json.at("parameters")};
}

Json to_json(const Reason& reason) {
  return {{"why", to_string(reason.why)},
          {"position", reason.position},
          {"r_squared", reason.r_squared},
          {"confidence", reason.confidence},
          {"second_position", reason.second_position},
          {"second_part", reason.second_part},
          {"evaluations", reason.evaluations},
          {"dead", reason.dead}};
}

/// Version 2 of before kept words, which nothing can be learned from.
Reason reason_from(const Json& json) {
  if (json.is_string()) return {};
  return {.why = named(kWhys, json.at("why")),
          .position = json.at("position"),
          .r_squared = json.at("r_squared"),
          .confidence = json.at("confidence"),
          .second_position = json.at("second_position"),
          .second_part = json.at("second_part"),
          .evaluations = json.at("evaluations"),
          .dead = json.at("dead")};
}

Json to_json(const Focus& focus) {
  const Verdict& verdict = focus.verdict;
  Json json = {{"result", to_string(focus.result())}, {"confidence", verdict.confidence},
               {"peak", to_json(focus.peak)},         {"contrast", verdict.rise.contrast},
               {"rise", verdict.rise.rise},           {"needed_rise", verdict.rise.needed},
               {"reason", to_json(verdict.reason)}};
  json["lobes"] = Json::array();
  for (const Peak& lobe : focus.lobes) json["lobes"].push_back(to_json(lobe));
  return json;
}

Focus focus_from(const Json& json, std::vector<Evaluation> evaluations) {
  Focus focus;
  focus.verdict = {named(kResults, json.at("result")),
                   {json.at("contrast"), json.at("rise"), json.at("needed_rise")},
                   json.at("confidence"),
                   reason_from(json.at("reason"))};
  focus.peak = peak_from(json.at("peak"));
  for (const Json& lobe : json.at("lobes")) focus.lobes.push_back(peak_from(lobe));
  focus.evaluations = std::move(evaluations);
  return focus;
}

Json to_json(const Run& run) {
  Json json = Json::object();
  if (run.target_mm) json["target_mm"] = *run.target_mm;
  if (run.limits) json["search"] = to_json(*run.limits);
  json["repeat_scatter"] = run.repeat_scatter;
  if (run.tracks) json["tracks"] = true;
  json["evaluations"] = Json::array();
  int loop = 0;
  for (const Measurement& m : run.measurements) json["evaluations"].push_back(to_json(m, ++loop));
  if (run.focus) json["focus"] = to_json(*run.focus);
  return json;
}

Run run_from(const Json& json) {
  Run run;
  if (json.contains("target_mm")) run.target_mm = json.at("target_mm").get<double>();
  if (json.contains("search")) run.limits = limits_from(json.at("search"));
  run.repeat_scatter = json.at("repeat_scatter");
  run.tracks = json.value("tracks", false);
  for (const Json& m : json.at("evaluations")) run.measurements.push_back(measurement_from(m));
  if (json.contains("focus")) run.focus = focus_from(json.at("focus"), run.evaluations());
  return run;
}

RunFile record_from(const Json& json, std::string_view name) {
  if (json.at("format") != kFormat || json.at("version") != kVersion) {
    throw Error(
        ErrorCode::bad_data,
        fmt::format("its format is {} {}, and this program reads {} {}", json.at("format").dump(),
                    json.at("version").dump(), kFormat, kVersion));
  }
  RunFile record;
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

std::string RunFile::json() const {
  Json json = {{"format", kFormat}, {"version", kVersion}, {"setup", to_json(setup)}};
  json["runs"] = Json::array();
  for (const Run& run : runs) json["runs"].push_back(to_json(run));
  if (calibration) json["calibration"] = Json::parse(calibration->json());
  json["extrapolate"] = extrapolate;
  if (distance) json["distance"] = {{"mm", distance->mm}, {"sigma_mm", distance->sigma_mm}};
  if (!error.empty()) json["error"] = error;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

RunFile RunFile::parse(std::string_view text, std::string_view name) {
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
