// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "tools/fathom/reproduce/report.hpp"

namespace fathom::reproduce {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Summary& s) {
  return {{"count", s.count}, {"mean", s.mean}, {"sd", s.sd}, {"least", s.least}, {"most", s.most}};
}

Json json_of(const Line& line) {
  return {{"intercept", line.intercept}, {"slope", line.slope}, {"r_squared", line.r_squared}};
}

Json json_of(const Ratio& ratio) {
  return {{"count", ratio.count}, {"ratio", ratio.value}, {"low", ratio.low}, {"high", ratio.high}};
}

Json json_of(const std::vector<FocusRun>& runs) {
  Json list = Json::array();
  for (const FocusRun& run : runs) {
    list.push_back({{"distance_mm", run.distance_mm},
                    {"result", to_string(run.result)},
                    {"position", run.position},
                    {"sigma", run.sigma},
                    {"evaluations", run.evaluations},
                    {"start", run.start},
                    {"travel", run.travel},
                    {"rig_seconds", run.rig_seconds},
                    {"frames", run.frames}});
  }
  return list;
}

Json json_of(const Trial& trial) {
  return {{"name", trial.name},
          {"calibration", kTransforms[trial.transform].metric},
          {"runs", trial.runs.size()},
          {"answers", trial.answers},
          {"wrong", trial.wrong},
          {"no_focus", trial.no_focus},
          {"others", trial.others},
          {"error_part", json_of(trial.error)},
          {"absolute_error_part", json_of(trial.size)},
          {"evaluations", json_of(trial.evaluations)},
          {"each", json_of(trial.runs)}};
}

Json json_of(const std::vector<Trial>& trials) {
  Json list = Json::array();
  for (const Trial& trial : trials) list.push_back(json_of(trial));
  return list;
}

Json json_of(const Looks& looks) {
  Json list = Json::array();
  for (const Look& look : looks.looks) {
    for (const SpectrumLook& spectrum : look.spectra) {
      list.push_back({{"target", kTargets[look.target]},
                      {"in_focus", look.sharp},
                      {"position", look.position},
                      {"metric", kTransforms[spectrum.transform].metric},
                      {"score", spectrum.score},
                      {"bands", spectrum.bands}});
    }
  }
  return list;
}

Json json_of(const Curves& curves) {
  Json list = Json::array(), floors = Json::array();
  for (const MeasuredCurves& curve : curves.curves) {
    list.push_back({{"distance_mm", curve.distance_mm},
                    {"true_position", curve.truth},
                    {"best_positions", curve.best},
                    {"fitted_positions", curve.fitted},
                    {"lobes", curve.lobes},
                    {"positions", curve.positions},
                    {"scores", curve.scores}});
  }
  for (const FarFloor& floor : curves.floors) {
    floors.push_back({{"target", floor.target},
                      {"distance_mm", floor.distance_mm},
                      {"level", floor.level},
                      {"roughness_of_peak", floor.of_peak},
                      {"roughness_of_level", floor.of_level}});
  }
  return {{"curves", list},
          {"far_floors", floors},
          {"fft_over_paley_of_peak", json_of(curves.paley_of_peak)},
          {"fft_over_sequency_of_peak", json_of(curves.sequency_of_peak)},
          {"fft_over_paley_of_level", json_of(curves.paley_of_level)},
          {"fft_over_sequency_of_level", json_of(curves.sequency_of_level)}};
}

Json json_of(const Calibrations& calibrations) {
  Json list = Json::array();
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    const CalibrationPair& pair = calibrations[t];
    Json parameters = Json::object();
    for (const CalibrationParameter& p : pair.own->parameters()) parameters[p.name] = p.value;
    list.push_back({{"metric", kTransforms[t].metric},
                    {"thesis_way",
                     {{"model", to_string(pair.thesis_curve.model)},
                      {"b0", pair.thesis_curve.b0},
                      {"b1", pair.thesis_curve.b1},
                      {"r_squared", pair.thesis_curve.r_squared},
                      {"residuals_mm", pair.residuals_mm},
                      {"runs", json_of(pair.thesis_runs)}}},
                    {"own_way",
                     {{"model", to_string(pair.own->model())},
                      {"parameters", parameters},
                      {"r_squared", pair.own->r_squared()},
                      {"position_scatter", pair.own->position_scatter()},
                      {"runs", json_of(pair.own_runs)}}}});
  }
  return list;
}

Json json_of(const RowOutcome& outcome, double actual_mm) {
  return {{"measured_mm", json_of(outcome.summary())},
          {"difference_part", outcome.difference_part(actual_mm)},
          {"each_mm", outcome.measured_mm},
          {"runs", json_of(outcome.runs)}};
}

Json json_of(const std::vector<TableSet>& sets) {
  Json list = Json::array();
  for (const TableSet& set : sets) {
    Json rows = Json::array();
    for (const TableRow& row : set.rows) {
      rows.push_back({{"actual_mm", row.actual_mm},
                      {"thesis",
                       {{"measured_mm", row.thesis_mm},
                        {"difference_percent", row.thesis_percent},
                        {"three_sd_mm", row.thesis_three_sd_mm}}},
                      {"thesis_way", json_of(row.old_way, row.actual_mm)},
                      {"own_way", json_of(row.own_way, row.actual_mm)}});
    }
    list.push_back({{"test", set.test},
                    {"object", set.object},
                    {"metric", kTransforms[set.transform].metric},
                    {"regression",
                     {{"thesis", json_of(set.thesis)},
                      {"thesis_way", json_of(set.old_line)},
                      {"own_way", json_of(set.own_line)}}},
                    {"rows", rows}});
  }
  return list;
}

Json json_of(const Repeatability& repeatability) {
  Json list = Json::array();
  for (const Readings& readings : repeatability.readings) {
    Json transforms = Json::object();
    for (std::size_t t = 0; t < kTransformCount; ++t) {
      transforms[kTransforms[t].metric] = {{"half_range_part", readings.of(t).half_range_part()},
                                           {"sd_part", readings.of(t).sd / readings.of(t).mean}};
    }
    list.push_back({{"distance_mm", readings.distance_mm},
                    {"far_from_focus", readings.far},
                    {"frames", readings.average},
                    {"transforms", transforms},
                    {"scores", readings.scores}});
  }
  return list;
}

Json json_of(const Orange& orange) {
  Json list = Json::array();
  for (const Orange::Patch& patch : orange.patches) {
    list.push_back({{"side", patch.side},
                    {"distance_mm", patch.distance_mm},
                    {"thesis_way", json_of(patch.old_way)},
                    {"own_way", json_of(patch.own_way)}});
  }
  return list;
}

Json json_of(const Searches& searches) {
  Json sides = Json::array();
  for (const Searches::Side& side : searches.sides) {
    sides.push_back({{"side", side.side},
                     {"chart", json_of(side.chart)},
                     {"seedling", json_of(side.seedling)}});
  }
  return {{"bracketed", json_of(searches.bracketed)},
          {"whole_travel_golden", json_of(searches.bare)},
          {"sides", sides}};
}

Json json_of(const Ways& ways) {
  Json list = Json::array(), noise = Json::array();
  for (const Way* way : ways.all()) {
    list.push_back({{"way", json_of(way->trial)},
                    {"travel", json_of(way->travel)},
                    {"travel_over_direct", way->times_direct},
                    {"rig_seconds", json_of(way->rig_seconds)},
                    {"frames", json_of(way->frames)},
                    {"within_half_percent", way->close},
                    {"error_over_sigma_rms", way->off_in_sigmas}});
  }
  for (const NoiseLevel& level : ways.noise) {
    noise.push_back({{"noise", level.times},
                     {"decibels", level.decibels()},
                     {"coarse", json_of(level.coarse)},
                     {"spectral", json_of(level.spectral)}});
  }
  return {{"ways", list}, {"noise", noise}, {"blank", json_of(ways.blank)}};
}

Json json_of(const std::vector<Claim>& claims) {
  Json list = Json::array();
  for (const Claim& claim : claims) {
    list.push_back({{"id", claim.id},
                    {"claim", claim.claim},
                    {"where", claim.where},
                    {"thesis", claim.thesis},
                    {"ours", claim.ours},
                    {"outcome", to_string(claim.outcome)}});
  }
  return list;
}

Json json_of(const ThisRun& this_run) {
  Json times = Json::array();
  for (const cli::ThesisTime& time : this_run.times.rows) {
    times.push_back({{"what", time.what},
                     {"thesis_least_s", time.least_s},
                     {"thesis_most_s", time.most_s},
                     {"here_s", time.here_s}});
  }
  return {{"times", times},
          {"program", this_run.program},
          {"device", this_run.times.device},
          {"machine", this_run.machine},
          {"date", this_run.date}};
}

}  // namespace

std::string results_json(const Results& results, const std::vector<Claim>& claims,
                         const ThisRun& this_run) {
  const Json json = {{"format", "fathom-reproduction"},
                     {"version", 1},
                     {"quick", results.effort.quick},
                     {"seed", kSeed},
                     {"looks", json_of(results.looks)},
                     {"curves", json_of(results.curves)},
                     {"calibrations", json_of(results.calibrations)},
                     {"tables", json_of(results.tables)},
                     {"repeatability", json_of(results.repeatability)},
                     {"own_way",
                      {{"whole_travel", json_of(results.own.whole)},
                       {"working_range", json_of(results.own.working)},
                       {"seedlings", json_of(results.own.plants)},
                       {"random", json_of(results.own.random)},
                       {"blank", json_of(results.own.blank)}}},
                     {"orange", json_of(results.orange)},
                     {"searches", json_of(results.searches)},
                     {"ways", json_of(results.ways)},
                     {"claims", json_of(claims)},
                     {"speed", json_of(this_run)}};
  return json.dump(1) + "\n";
}

}  // namespace fathom::reproduce
