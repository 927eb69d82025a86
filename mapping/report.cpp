// SPDX-License-Identifier: Apache-2.0
#include "mapping/report.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include "depth/align.hpp"
#include "session/json_line.hpp"

namespace fathom::mapping {
namespace {

std::string classes_json(const DepthSummary& summary, std::size_t pixels) {
  std::string list;
  for (const DepthClass value : kAllDepthClasses) {
    list += (list.empty() ? "" : ",") + JsonLine()
                                            .add("value", static_cast<int>(value))
                                            .add("name", to_string(value))
                                            .add("part", summary.part(value, pixels))
                                            .text();
  }
  return "[" + list + "]";
}

std::string names_json(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names)
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ",", name);  // our own, without quotes
  return "[" + list + "]";
}

std::string blur_json(const BlurModel& blur) {
  return JsonLine()
      .add("px_per_unit", blur.px_per_unit)
      .add("rest_px", blur.rest_px)
      .add("shape", to_string(blur.shape))
      .text();
}

std::string depth_json(const DepthResult& result, const DepthSummary& summary) {
  return JsonLine()
      .add("unit", result.unit)
      .add("lowest", summary.nearest)
      .add("percentile_2", summary.low)
      .add("percentile_98", summary.high)
      .add("highest", summary.farthest)
      .add("median_sigma", summary.median_sigma)
      .text();
}

void add_options(JsonLine& line, const ReportFacts& facts) {
  JsonLine options;
  options.add("window", facts.window);
  if (facts.stride) {
    options.add("stride", *facts.stride);
  } else {
    options.add("stride", "auto");
  }
  options.add("align", facts.align);
  options.add_json("fill", facts.is_filled ? "true" : "false");
  line.add_json("options", options.text());
}

/// Where the places of the frames are from.
std::string alignment_json(const ReportFacts& facts) {
  JsonLine line;
  if (!facts.growth)
    return line.add("by", facts.align == to_string(Alignment::none) ? "none" : "estimate").text();
  line.add("by", "law").add("told_growth_per_unit", facts.growth->told);
  return line.add("growth_per_unit", facts.growth->fitted).text();
}

/// How each frame lies on the first one, where that is kept.
void add_seen(JsonLine& line, const DepthResult& result) {
  if (result.seen.empty()) return;
  std::string places;
  std::vector<double> gains;
  for (const Seen& seen : result.seen) {
    gains.push_back(seen.gain);
    places += (places.empty() ? "" : ",") + JsonLine()
                                                .add("scale", seen.place.scale)
                                                .add("angle_rad", seen.place.angle_rad)
                                                .add("dx_px", seen.place.dx_px)
                                                .add("dy_px", seen.place.dy_px)
                                                .text();
  }
  line.add_json("places", "[" + places + "]").add("gains", gains);
}

/// A member a line, so that people can read it too.
std::string with_lines(const std::string& json) {
  std::string text;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string && c == '\\') {
      text += c;
      text += json[++i];
      continue;
    }
    if (c == '"') in_string = !in_string;
    if (!in_string && (c == '{' || c == '[')) ++depth;
    if (!in_string && (c == '}' || c == ']')) --depth;
    if (!in_string && c == '}' && depth == 0) text += '\n';
    text += c;
    const bool breaks = !in_string && depth == 1 && (c == ',' || (c == '{' && text.size() == 1));
    if (breaks) text += "\n  ";
  }
  return text + "\n";
}

}  // namespace

std::string report_json(const DepthResult& result, const DepthSummary& summary,
                        const ReportFacts& facts) {
  JsonLine line;
  line.add("format", "fathom-depth").add("version", 1).add("made", facts.made);
  line.add("rig", result.rig);
  line.add("width_px", result.maps.width_px).add("height_px", result.maps.height_px);
  line.add("frames", result.positions.size()).add("frames_expected", facts.frames_expected);
  line.add("position_unit", result.lens_unit).add("positions", result.positions);
  if (result.spacing_um) line.add("spacing_um", *result.spacing_um);
  if (facts.calibration.empty()) {
    line.add_null("calibration");
  } else {
    line.add("calibration", facts.calibration);
  }
  add_options(line, facts);
  line.add_json("alignment", alignment_json(facts));
  line.add("moved_px", facts.moved_px);
  add_seen(line, result);
  line.add("backend", facts.backend);
  if (result.blur) line.add_json("blur", blur_json(*result.blur));
  line.add_json("depth", depth_json(result, summary));
  line.add_json("classes", classes_json(summary, result.pixels()));
  line.add_json("files", names_json(facts.files));
  line.add_json("seconds", JsonLine()
                               .add("reading_and_scoring", facts.read_seconds)
                               .add("mapping", facts.map_seconds)
                               .add("writing", facts.write_seconds)
                               .text());
  line.add("memory_mb", peak_memory_mb());
  return with_lines(line.text());
}

double peak_memory_mb() {
  constexpr double kKilobytes = 1024;
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * kKilobytes / 1e6;
}

}  // namespace fathom::mapping
