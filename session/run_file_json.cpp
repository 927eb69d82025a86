// SPDX-License-Identifier: Apache-2.0
// The run file: names on both sides of one page, so that writing and reading cannot drift apart.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/error.hpp"
#include "session/focus_json.hpp"
#include "session/run_file.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fathom-run";
/// What version 2 was called.
constexpr const char* kOldFormat = "fathom-record";
constexpr int kOldVersion = 2;

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
  LensInfo lens{.description = json.at("description"),
                .unit = json.at("unit"),
                .lowest = json.at("lowest"),
                .highest = json.at("highest"),
                .resolution = json.at("resolution"),
                .coarse_spacing = json.at("coarse_spacing"),
                .stops = json.value("stops", std::vector<double>())};
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
  return {.position = json.at("position"),
          .score = json.at("score"),
          .started_ns = json.at("started_ns"),
          .stopped_ns = json.at("stopped_ns"),
          .settled_ns = json.at("settled_ns"),
          .exposure = {json.at("exposure_start_ns"), json.at("exposure_end_ns")},
          .compute_ns = json.at("compute_ns"),
          .saturated = json.value("saturated", 0.0),
          .note = json.value("note", std::string())};
}

Json to_json(const Run& run, const LensInfo& lens) {
  Json json = Json::object();
  if (run.target_mm) json["target_mm"] = *run.target_mm;
  if (run.limits) json["search"] = to_json(*run.limits);
  json["repeat_scatter"] = run.repeat_scatter;
  if (run.tracks) json["tracks"] = true;
  json["evaluations"] = Json::array();
  int loop = 0;
  for (const Measurement& m : run.measurements) json["evaluations"].push_back(to_json(m, ++loop));
  if (run.focus) json["focus"] = focus_to_json(*run.focus, lens);
  return json;
}

Run run_from(const Json& json, int version) {
  Run run;
  if (json.contains("target_mm")) run.target_mm = json.at("target_mm").get<double>();
  if (json.contains("search")) run.limits = limits_from(json.at("search"));
  run.repeat_scatter = json.at("repeat_scatter");
  run.tracks = json.value("tracks", false);
  for (const Json& m : json.at("evaluations")) run.measurements.push_back(measurement_from(m));
  if (!json.contains("focus")) return run;
  const Json& focus = json.at("focus");
  run.focus = version == kOldVersion ? focus_from_version_2(focus, run.evaluations())
                                     : focus_from_json(focus);
  return run;
}

/// Throws Error(bad_data) for a format or version that is not read.
int version_of(const Json& json) {
  const Json& format = json.at("format");
  const Json& version = json.at("version");
  if (format == kFormat && version == RunFile::kVersion) return RunFile::kVersion;
  if (format == kOldFormat && version == kOldVersion) return kOldVersion;
  throw Error(
      ErrorCode::bad_data,
      fmt::format("its format is {} {}, and this program reads {} {} and {} {}", format.dump(),
                  version.dump(), kFormat, RunFile::kVersion, kOldFormat, kOldVersion));
}

RunFile file_from(const Json& json, std::string_view name) {
  RunFile file;
  file.version = version_of(json);
  file.setup = setup_from(json.at("setup"));
  for (const Json& run : json.at("runs")) file.runs.push_back(run_from(run, file.version));
  if (json.contains("calibration")) {
    file.calibration = Calibration::parse(json.at("calibration").dump(), name);
  }
  file.extrapolate = json.at("extrapolate");
  if (json.contains("distance")) {
    file.distance = Distance{json.at("distance").at("mm"), json.at("distance").at("sigma_mm")};
  }
  file.error = json.value("error", std::string());
  return file;
}

}  // namespace

std::string RunFile::json() const {
  Json json = {{"format", kFormat}, {"version", kVersion}, {"setup", to_json(setup)}};
  json["runs"] = Json::array();
  for (const Run& run : runs) json["runs"].push_back(to_json(run, setup.lens));
  if (calibration) json["calibration"] = Json::parse(calibration->json());
  json["extrapolate"] = extrapolate;
  if (distance) json["distance"] = {{"mm", distance->mm}, {"sigma_mm", distance->sigma_mm}};
  if (!error.empty()) json["error"] = error;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

RunFile RunFile::parse(std::string_view text, std::string_view name) {
  try {
    return file_from(Json::parse(text), name);
  } catch (const Json::exception&) {
    throw Error(ErrorCode::bad_data, fmt::format("{} is damaged or no run file", name));
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{} is no run file: {}", name, error.what()));
  }
}

}  // namespace fathom
