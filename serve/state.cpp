// SPDX-License-Identifier: Apache-2.0
#include "serve/state.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "session/json_line.hpp"

namespace fathom::serve {
namespace {

constexpr std::pair<Activity, const char*> kNames[] = {
    {Activity::live, "live"},   {Activity::aim, "aim"},         {Activity::focus, "focus"},
    {Activity::sweep, "sweep"}, {Activity::range, "range"},     {Activity::calibrate, "calibrate"},
    {Activity::depth, "depth"}, {Activity::capture, "capture"}, {Activity::stopping, "stopping"}};

const char* word(bool value) { return value ? "true" : "false"; }

template <typename List, typename Text>
std::string array_of(const List& list, const Text& text_of) {
  std::string text = "[";
  for (const auto& one : list) text += (text.size() > 1 ? "," : "") + text_of(one);
  return text + "]";
}

std::string strings_of(const std::vector<std::string>& list) {
  return array_of(list, [](const std::string& one) {
    // {"":"text"} without what is not the text.
    constexpr std::size_t kKey = 3;
    return JsonLine().add("", one).body().substr(kKey);
  });
}

std::string lens_of(const State& state) {
  const LensInfo& lens = state.lens;
  JsonLine line;
  line.add("unit", lens.unit).add("min", lens.lowest).add("max", lens.highest);
  line.add("step", lens.resolution);
  lens.stops.empty() ? line.add_null("stops") : line.add("stops", lens.stops);
  state.position ? line.add("position", *state.position) : line.add_null("position");
  return line.add_json("moving", word(state.is_moving)).text();
}

std::string camera_of(const State& state) {
  return JsonLine()
      .add("width", state.width_px)
      .add("height", state.height_px)
      .add("max_value", state.most_grey)
      .add_json("streams", word(state.is_streaming))
      .text();
}

std::string text_of(const Window& window) {
  return JsonLine().add("x", window.x).add("y", window.y).add("n", window.n).text();
}

std::string text_of(const PointView& point) {
  return JsonLine()
      .add("position", point.position)
      .add("score", point.score)
      .add("from_ms", static_cast<std::size_t>(std::max<std::int64_t>(point.from_ms, 0)))
      .text();
}

std::string text_of(const MeasurementView& measurement) {
  JsonLine line;
  line.add("id", measurement.id).add("kind", to_string(measurement.kind));
  line.add("began_ns", static_cast<std::size_t>(measurement.began_ns));
  line.add_json("points", array_of(measurement.points,
                                   [](const PointView& point) { return text_of(point); }));
  line.add("positions_expected", measurement.positions).add("scatter", measurement.scatter);
  line.add_json("warnings", strings_of(measurement.warnings));
  return line.add_json("result", measurement.result.empty() ? "null" : measurement.result).text();
}

std::string text_of(const CalibrationView& calibration) {
  const auto point_text = [](const CalibrationView::Point& point) {
    return JsonLine()
        .add("distance", point.distance_mm)
        .add("position", point.position)
        .add("sigma", point.sigma)
        .text();
  };
  JsonLine line;
  line.add("distances", calibration.distances_mm);
  line.add_json("points", array_of(calibration.points, point_text));
  line.add_json("waiting_for_next", word(calibration.is_waiting));
  return line.add_json("fit", calibration.fit.empty() ? "null" : calibration.fit).text();
}

template <typename View>
std::string text_or_null(const std::optional<View>& view) {
  return view ? text_of(*view) : "null";
}

}  // namespace

const char* to_string(Activity activity) noexcept {
  return std::ranges::find(kNames, activity, &std::pair<Activity, const char*>::first)->second;
}

std::string state_members(const State& state) {
  JsonLine line;
  line.add("version", state.version).add("rig", state.rig).add("description", state.description);
  line.add_json("read_only", word(state.is_read_only));
  line.add_json("camera", camera_of(state)).add_json("lens", lens_of(state));
  line.add_json("stage", word(state.has_stage));
  line.add("metric", state.metric).add("search", state.search);
  line.add_json("windows",
                array_of(state.windows, [](const Window& window) { return text_of(window); }));
  line.add("activity", to_string(state.activity));
  state.problem.empty() ? line.add_null("problem") : line.add("problem", state.problem);
  line.add_json("calibrations", strings_of(state.calibrations));
  line.add_json("measurement", text_or_null(state.measurement));
  line.add_json("calibration", text_or_null(state.calibration));
  line.add_json("map", state.map.empty() ? "null" : state.map);
  return line.body();
}

}  // namespace fathom::serve
