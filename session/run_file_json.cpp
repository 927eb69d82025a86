// SPDX-License-Identifier: Apache-2.0
// The run file: names on both sides of one page, so that writing and reading cannot drift apart.
#include <fmt/format.h>

#include "calibration/blur_json.hpp"
#include "engine/cache.hpp"
#include "engine/error.hpp"
#include "engine/json.hpp"
#include "session/focus_json.hpp"
#include "session/run_file.hpp"

namespace fathom {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "fathom-run";
/// What version 2 was called.
constexpr const char* kOldFormat = "fathom-record";
constexpr int kOldVersion = 2;
constexpr const char* kDigest = "digest";

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
  if (!lens.stop_names.empty()) json["stop_names"] = lens.stop_names;
  if (lens.optics) json["optics"] = to_json(*lens.optics);
  if (lens.blur_px_per_unit) json["blur_px_per_unit"] = *lens.blur_px_per_unit;
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
  lens.stop_names = json.value("stop_names", std::vector<std::string>());
  if (json.contains("blur_px_per_unit"))
    lens.blur_px_per_unit = json.at("blur_px_per_unit").get<double>();
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

Window window_from(const Json& json) {
  return {whole_from<int>(json.at(0)), whole_from<int>(json.at(1)), whole_from<int>(json.at(2))};
}

RunSetup setup_from(const Json& json) {
  RunSetup setup;
  setup.verb = json.at("verb");
  setup.command = json.at("command");
  setup.created = json.at("created");
  setup.rig = json.at("rig");
  setup.camera = json.at("camera");
  setup.lens = lens_from(json.at("lens"));
  setup.metric = MetricSpec::parse(json.at("metric").get<std::string>());
  setup.window = window_from(json.at("window"));
  setup.backend = json.at("backend");
  setup.backend_reason = json.at("backend_reason");
  setup.average = whole_from<int>(json.at("average"));
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
               {"first_step", limits.first_step},
               {"lowest", limits.lowest},
               {"highest", limits.highest},
               {"is_live", limits.is_live},
               {"largest_window", limits.largest_window}};
  if (limits.bracket) {
    json["bracket"] = {limits.bracket->low, limits.bracket->inner, limits.bracket->high};
  }
  if (limits.blur) json["blur"] = to_json(*limits.blur);
  if (limits.returns) json["returns"] = true;
  if (limits.moves) json["moves"] = true;
  if (limits.most_pictures > 0) json["most_pictures"] = limits.most_pictures;
  return json;
}

FocusLimits limits_from(const Json& json) {
  FocusLimits limits;
  limits.search = parse_search_method(json.at("method").get<std::string>());
  limits.peak = parse_peak_method(json.at("peak").get<std::string>());
  limits.from = json.at("from");
  limits.to = json.at("to");
  limits.tolerance = json.at("tolerance");
  limits.coarse = {json.at("coarse").get<std::vector<double>>(),
                   whole_from<int>(json.at("halvings")), json.at("spacing_is_guess")};
  limits.start = json.at("start");
  limits.first_step = json.at("first_step");
  limits.is_live = json.value("is_live", false);
  limits.largest_window = json.value("largest_window", false);
  limits.lowest = json.value("lowest", limits.from);
  limits.highest = json.value("highest", limits.to);
  if (json.contains("bracket")) {
    const Json& bracket = json.at("bracket");
    limits.bracket = Bracket{bracket.at(0), bracket.at(1), bracket.at(2)};
  }
  if (json.contains("blur")) limits.blur = blur_from(json.at("blur"));
  limits.returns = json.value("returns", false);
  limits.moves = json.value("moves", false);
  if (json.contains("most_pictures"))
    limits.most_pictures = whole_from<int>(json.at("most_pictures"));
  return limits;
}

Json to_json(const PictureFacts& picture) {
  Json json = {{"brightness", picture.brightness},
               {"light", picture.light},
               {"deviation", picture.deviation},
               {"noise", picture.noise},
               {"saturated", picture.saturated},
               {"parts", picture.parts},
               {"part_brightness", picture.part_brightness}};
  if (!picture.cells.empty()) json["cells"] = picture.cells;
  if (picture.rings.empty()) return json;
  json["rings"] = Json::array();
  for (const RingPowers& rings : picture.rings)
    json["rings"].push_back({{"side", rings.side}, {"powers", rings.powers}});
  return json;
}

std::vector<RingPowers> rings_from(const Json& json) {
  std::vector<RingPowers> all;
  for (const Json& rings : json) {
    all.push_back(
        {whole_from<int>(rings.at("side")), rings.at("powers").get<std::vector<float>>()});
  }
  return all;
}

std::vector<std::uint32_t> cells_from(const Json& json) {
  std::vector<std::uint32_t> cells;
  for (const Json& cell : json) cells.push_back(whole_from<std::uint32_t>(cell));
  return cells;
}

/// Of a measurement. Before version 4 only the saturated part was kept.
PictureFacts picture_from(const Json& measurement) {
  if (!measurement.contains("picture")) return {.saturated = measurement.value("saturated", 0.0)};
  const Json& json = measurement.at("picture");
  return {.brightness = json.at("brightness"),
          .light = json.at("light"),
          .deviation = json.at("deviation"),
          .noise = json.at("noise"),
          .saturated = json.at("saturated"),
          .parts = json.at("parts"),
          .part_brightness = json.value("part_brightness", std::array<double, kParts>{}),
          .rings = rings_from(json.value("rings", Json::array())),
          .cells = cells_from(json.value("cells", Json::array()))};
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
  if (m.on_the_way)
    json["on_the_way"] = {{"sigma", m.on_the_way->sigma}, {"smear", m.on_the_way->smear}};
  if (m.set_out_from) json["set_out_from"] = *m.set_out_from;
  if (m.frames != 1) json["frames"] = m.frames;
  if (m.brightness_share != 0) json["brightness_share"] = m.brightness_share;
  json["picture"] = to_json(m.picture);
  if (!m.note.empty()) json["note"] = m.note;
  return json;
}

Measurement measurement_from(const Json& json) {
  const auto time = [&json](const char* name) { return whole_from<std::int64_t>(json.at(name)); };
  std::optional<OnTheWay> on_the_way;
  if (json.contains("on_the_way")) {
    const Json& way = json.at("on_the_way");
    on_the_way = OnTheWay{.sigma = way.at("sigma"), .smear = way.at("smear")};
  }
  std::optional<double> set_out_from;
  if (json.contains("set_out_from")) set_out_from = json.at("set_out_from").get<double>();
  return {.position = json.at("position"),
          .on_the_way = on_the_way,
          .set_out_from = set_out_from,
          .score = json.at("score"),
          .brightness_share = json.value("brightness_share", 0.0),
          .started_ns = time("started_ns"),
          .stopped_ns = time("stopped_ns"),
          .settled_ns = time("settled_ns"),
          .exposure = {time("exposure_start_ns"), time("exposure_end_ns")},
          .compute_ns = time("compute_ns"),
          .frames = json.contains("frames") ? whole_from<int>(json.at("frames")) : 1,
          .picture = picture_from(json),
          .note = json.value("note", std::string())};
}

Json to_json(const Resemblance& resemblance) {
  return {{"evidence", resemblance.evidence}, {"evenness", resemblance.evenness}};
}

Resemblance resemblance_from(const Json& json) {
  return {.evidence = json.at("evidence"), .evenness = json.at("evenness")};
}

Json to_json(const FirstLook& look) {
  return {{"foretold_px", look.foretold_px},
          {"seen_px", look.seen_px},
          {"unexplained", look.unexplained},
          {"evidence", look.evidence},
          {"evidence_beside", look.evidence_beside}};
}

FirstLook first_look_from(const Json& json) {
  return {.foretold_px = json.at("foretold_px"),
          .seen_px = json.at("seen_px"),
          .unexplained = json.at("unexplained"),
          .evidence = json.at("evidence"),
          .evidence_beside = json.at("evidence_beside")};
}

Json to_json(const Run& run, const LensInfo& lens) {
  Json json = Json::object();
  if (run.target_mm) json["target_mm"] = *run.target_mm;
  if (run.limits) json["search"] = to_json(*run.limits);
  json["repeat_scatter"] = run.repeat_scatter;
  if (run.lost_part > 0) json["lost_part"] = run.lost_part;
  if (run.start_position) json["start_position"] = *run.start_position;
  if (run.started_ns) json["started_ns"] = *run.started_ns;
  if (run.repeats > 0) json["repeats"] = run.repeats;
  if (run.resemblance) json["resemblance"] = to_json(*run.resemblance);
  if (run.first_look) json["first_look"] = to_json(*run.first_look);
  if (run.tracks) json["tracks"] = true;
  if (run.by_time) json["by_time"] = true;
  json["evaluations"] = Json::array();
  int loop = 0;
  for (const Measurement& m : run.measurements) json["evaluations"].push_back(to_json(m, ++loop));
  if (run.focus) json["focus"] = focus_to_json(*run.focus, lens);
  if (!run.spectrum.empty()) json["spectrum"] = run.spectrum;
  return json;
}

Run run_from(const Json& json, int version) {
  Run run;
  if (json.contains("target_mm")) run.target_mm = json.at("target_mm").get<double>();
  if (json.contains("search")) run.limits = limits_from(json.at("search"));
  run.repeat_scatter = json.at("repeat_scatter");
  run.lost_part = json.value("lost_part", 0.0);
  if (json.contains("start_position")) run.start_position = json.at("start_position").get<double>();
  if (json.contains("started_ns")) run.started_ns = whole_from<std::int64_t>(json.at("started_ns"));
  if (json.contains("repeats")) run.repeats = whole_from<int>(json.at("repeats"));
  if (json.contains("resemblance")) run.resemblance = resemblance_from(json.at("resemblance"));
  if (json.contains("first_look")) run.first_look = first_look_from(json.at("first_look"));
  run.tracks = json.value("tracks", false);
  run.by_time = json.value("by_time", false);
  run.spectrum = json.value("spectrum", std::vector<double>());
  for (const Json& m : json.at("evaluations")) run.measurements.push_back(measurement_from(m));
  if (!json.contains("focus")) return run;
  const Json& focus = json.at("focus");
  run.focus = version == kOldVersion ? focus_from_version_2(focus, run.evaluations())
                                     : focus_from_json(focus);
  return run;
}

Json to_json(const Distance& distance) {
  return {{"mm", distance.mm}, {"sigma_mm", distance.sigma_mm}};
}

Distance distance_from(const Json& json) { return {json.at("mm"), json.at("sigma_mm")}; }

Json to_json(const KeptSurface& surface) {
  Json json = {{"position", surface.position},
               {"sigma", surface.sigma},
               {"relief", surface.relief},
               {"box", {surface.x, surface.y, surface.width_px, surface.height_px}},
               {"area", surface.area},
               {"texture", surface.texture}};
  if (surface.window) json["window"] = {surface.window->x, surface.window->y, surface.window->n};
  if (surface.distance) json["distance"] = to_json(*surface.distance);
  return json;
}

KeptSurface surface_from(const Json& json) {
  const Json& box = json.at("box");
  KeptSurface surface{.position = json.at("position"),
                      .sigma = json.at("sigma"),
                      .relief = json.at("relief"),
                      .x = whole_from<int>(box.at(0)),
                      .y = whole_from<int>(box.at(1)),
                      .width_px = whole_from<int>(box.at(2)),
                      .height_px = whole_from<int>(box.at(3)),
                      .area = json.at("area"),
                      .texture = json.at("texture")};
  if (json.contains("window")) surface.window = window_from(json.at("window"));
  if (json.contains("distance")) surface.distance = distance_from(json.at("distance"));
  return surface;
}

std::vector<KeptSurface> surfaces_from(const Json& json) {
  std::vector<KeptSurface> surfaces;
  for (const Json& surface : json) surfaces.push_back(surface_from(surface));
  return surfaces;
}

/// What stands there, which may be no UTF-8.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

/// What the file's digest is of: everything else in it, however it is laid out.
std::string digest_of(Json json) {
  json.erase(kDigest);
  return fmt::format("{:016x}", hash_of(json.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

/// Throws Error(bad_data) for a format or version that is not read.
int version_of(const Json& json) {
  const Json& format = json.at("format");
  const Json& version = json.at("version");
  if (format == kFormat && (version == 3 || version == RunFile::kVersion)) return version;
  if (format == kOldFormat && version == kOldVersion) return kOldVersion;
  if (format == "fathom-calibration")
    throw Error(ErrorCode::bad_data, "it is a calibration, which follows from a run");
  throw Error(ErrorCode::bad_data,
              fmt::format("its format is {} {}, and this program reads {} 3 and {}, and {} {}",
                          text_of(format), text_of(version), kFormat, RunFile::kVersion, kOldFormat,
                          kOldVersion));
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
  if (json.contains("distance")) file.distance = distance_from(json.at("distance"));
  if (json.contains("surfaces")) file.surfaces = surfaces_from(json.at("surfaces"));
  file.error = json.value("error", std::string());
  if (json.contains(kDigest)) file.is_as_written = json.at(kDigest) == digest_of(json);
  return file;
}

}  // namespace

std::string RunFile::json() const {
  Json json = {{"format", kFormat}, {"version", kVersion}, {"setup", to_json(setup)}};
  json["runs"] = Json::array();
  for (const Run& run : runs) json["runs"].push_back(to_json(run, setup.lens));
  if (calibration) json["calibration"] = Json::parse(calibration->json());
  json["extrapolate"] = extrapolate;
  if (distance) json["distance"] = to_json(*distance);
  if (surfaces) {
    json["surfaces"] = Json::array();
    for (const KeptSurface& surface : *surfaces) json["surfaces"].push_back(to_json(surface));
  }
  if (!error.empty()) json["error"] = error;
  json[kDigest] = digest_of(json);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

RunFile RunFile::parse(std::string_view text, std::string_view name) {
  try {
    return file_from(parse_json(text), name);
  } catch (const Json::exception&) {
    throw Error(ErrorCode::bad_data, fmt::format("{} is damaged or no run file", name));
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{} is no run file: {}", name, error.what()));
  }
}

}  // namespace fathom
