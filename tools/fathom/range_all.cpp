// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/range_all.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "backends/backends.hpp"
#include "engine/file.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/depth/surveying.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {

using namespace mapping;
namespace {

/// What the list is made of.
struct List {
  Survey survey;
  std::optional<Calibration> calibration;
  std::vector<RangedSurface> surfaces;

  const SeenSurface& seen(const RangedSurface& one) const {
    return survey.surfaces.found[one.number];
  }
  KeptSurface kept(const RangedSurface& one) const {
    KeptSurface surface = kept_of(survey.surfaces, seen(one));
    if (one.window) surface.window = where_sharp(survey, *one.window);
    surface.distance = one.distance;
    return surface;
  }
  bool was_stopped() const { return survey.positions.size() < survey.expected; }
};

void measure(const RangeAllRequest& request, Taking& taking, RunKeeper& keeper, List& list) {
  std::optional<BlurModel> blur = request.blur;
  if (!blur && list.calibration) blur = list.calibration->conditions().blur;
  const OpenDevice open = [&](const MetricSpec& spec, std::size_t windows) {
    return select_device(all_backends(), request.backend, spec, windows, request.device);
  };
  list.survey = survey(taking, "surfaces", open, blur, keeper);
  list.surfaces = ranged(list.survey.surfaces, list.calibration ? &*list.calibration : nullptr,
                         request.extrapolate);
  keeper.file.surfaces.emplace();
  for (const RangedSurface& one : list.surfaces) keeper.file.surfaces->push_back(list.kept(one));
  if (list.was_stopped()) keeper.file.error = "stopped on request";
}

/// Distances count where there are some; a slope is that of the distance then.
double to_mm(const List& list, const SeenSurface& surface) {
  return list.calibration->slope_mm(surface.position);
}

/// Of the mean over its area, and no other of its places.
double mean_sigma_mm(const List& list, const SeenSurface& surface) {
  const double sigma = std::hypot(surface.sigma, list.calibration->position_scatter());
  return list.calibration->distance(surface.position, sigma).sigma_mm;
}

void add_distance(JsonLine& line, const List& list, const RangedSurface& one) {
  if (!one.distance) {
    line.add_null("distance_mm").add_null("sigma_mm");
    return;
  }
  const SeenSurface& surface = list.seen(one);
  const double mm = to_mm(list, surface);
  line.add("distance_mm", one.distance->mm).add("sigma_mm", one.distance->sigma_mm);
  line.add("mean_sigma_mm", mean_sigma_mm(list, surface));
  line.add("relief_mm", std::abs(mm) * surface.relief);
  line.add("spread_mm", std::abs(mm) * surface.spread);
  line.add("slope_x_mm", mm * surface.slope_x).add("slope_y_mm", mm * surface.slope_y);
}

std::string surface_json(const List& list, const RangedSurface& one) {
  const SeenSurface& surface = list.seen(one);
  const KeptSurface kept = list.kept(one);
  const PixelBox& box = surface.box;
  JsonLine line;
  add_distance(line, list, one);
  line.add("position", surface.position).add("sigma", place_sigma(kept));
  line.add("mean_sigma", surface.sigma).add("relief", surface.relief);
  line.add("spread", surface.spread);
  line.add("slope_x", surface.slope_x).add("slope_y", surface.slope_y);
  line.add_json("box", fmt::format("[{},{},{},{}]", box.x, box.y, box.width_px, box.height_px));
  line.add("centre_x", surface.centre_x).add("centre_y", surface.centre_y);
  line.add("area_px", surface.area_px).add("area", kept.area);
  line.add("texture", surface.texture).add("pieces", surface.pieces);
  if (!kept.window) return line.add_null("window").text();
  return line.add("window", to_string(*kept.window)).text();
}

void print_json(const List& list) {
  std::string surfaces;
  for (const RangedSurface& one : list.surfaces)
    surfaces += (surfaces.empty() ? "" : ",") + surface_json(list, one);
  JsonLine line;
  line.add("result", list.surfaces.empty() ? "no-surface" : "surfaces");
  line.add("order", list.calibration ? "nearest first" : "largest position first");
  line.add("position_unit", list.survey.unit).add("frames", list.survey.positions.size());
  line.add("frames_expected", list.survey.expected);
  line.add("width_px", list.survey.surfaces.width_px);
  line.add("height_px", list.survey.surfaces.height_px);
  line.add("known", list.survey.known);
  line.add_json("surfaces", "[" + surfaces + "]");
  line.add("small", list.survey.surfaces.small).add("left_out", list.survey.left_out);
  print_line(line.text());
}

void write_csv(const List& list, const std::string& path) {
  std::string csv =
      "distance_mm,sigma_mm,position,position_sigma,spread,slope_x,slope_y,x,y,width,height,"
      "centre_x,centre_y,area_px,texture,window_x,window_y,window_n,mean_sigma,relief,pieces\n";
  for (const RangedSurface& one : list.surfaces) {
    const SeenSurface& s = list.seen(one);
    const KeptSurface kept = list.kept(one);
    csv += one.distance ? fmt::format("{:.9g},{:.3g}", one.distance->mm, one.distance->sigma_mm)
                        : std::string(",");
    csv +=
        fmt::format(",{:.9g},{:.3g},{:.3g},{:.4g},{:.4g},{},{},{},{},{:.1f},{:.1f},{},{:.4f}",
                    s.position, place_sigma(kept), s.spread, s.slope_x, s.slope_y, s.box.x, s.box.y,
                    s.box.width_px, s.box.height_px, s.centre_x, s.centre_y, s.area_px, s.texture);
    csv += kept.window ? "," + to_string(*kept.window) : ",,,";
    csv += fmt::format(",{:.3g},{:.3g},{}\n", s.sigma, s.relief, s.pieces);
  }
  write_file(path, csv);
}

/// Where a surface leans, bends or holds several depths, its mean is surer than its places.
std::string mean_beside(const SeenSurface& surface, const std::string& mean_sigma) {
  constexpr double kWorthSaying = 2;
  if (surface.relief < kWorthSaying * surface.sigma) return "";
  return fmt::format(" (not level; its mean +- {})", mean_sigma);
}

std::string how_far(const List& list, const RangedSurface& one) {
  const SeenSurface& surface = list.seen(one);
  if (one.distance) {
    return fmt::format(
        "{:9.1f} mm +- {:.1f} mm{}", one.distance->mm, one.distance->sigma_mm,
        mean_beside(surface, fmt::format("{:.1f} mm", mean_sigma_mm(list, surface))));
  }
  const std::string& unit = list.survey.unit;
  const std::string place = fmt::format(
      "at {:.5g} {} +- {:.2g} {}{}", surface.position, unit, place_sigma(list.kept(one)), unit,
      mean_beside(surface, fmt::format("{:.2g} {}", surface.sigma, unit)));
  return list.calibration ? place + ", not covered by the calibration" : place;
}

std::string surface_line(const List& list, std::size_t i) {
  const RangedSurface& one = list.surfaces[i];
  const SeenSurface& surface = list.seen(one);
  const KeptSurface kept = list.kept(one);
  std::string line = fmt::format(
      "{:>3}  {}  {:4.1f} % of the picture, {:4.1f} % of its texture, box {},{} {} x {}", i + 1,
      how_far(list, one), 100 * kept.area, 100 * surface.texture, surface.box.x, surface.box.y,
      surface.box.width_px, surface.box.height_px);
  if (surface.pieces > 1) line += fmt::format(", in {} pieces", surface.pieces);
  if (kept.window) line += ", window " + to_string(*kept.window);
  return line;
}

void print_text(const List& list) {
  const std::size_t count = list.surfaces.size();
  print_line(fmt::format("{} surface{}, {}", count, count == 1 ? "" : "s",
                         list.calibration ? "the nearest first"
                                          : "the largest position first: no calibration tells "
                                            "distances, or which way is near"));
  for (std::size_t i = 0; i < count; ++i) print_line(surface_line(list, i));
}

/// What is said of parts that the pictures contradict.
std::string beyond(const List& list) {
  if (list.survey.left_out == 0) return "";
  return fmt::format(", {} left out whose detail is greatest elsewhere or at an end of the range",
                     list.survey.left_out);
}

void print_rest(const List& list) {
  const std::size_t small = list.survey.surfaces.small;
  print_line(fmt::format(
      "{:.1f} % of the picture has a depth{}; {} frames", 100 * list.survey.known,
      (small > 0 ? fmt::format(", {} small part{} left out", small, small == 1 ? "" : "s") : "") +
          beyond(list),
      list.survey.positions.size()));
}

/// Where no focus was seen, and where it may be.
std::string words_for_none(const List& list) {
  const char* const where =
      !list.survey.sharper ? "look for texture, light and a range that the focus lies in"
      : *list.survey.sharper == TravelEnd::low
          ? "the picture becomes sharper towards the low end: look there and beyond"
          : "the picture becomes sharper towards the high end: look there and beyond";
  return fmt::format(
      "no surface: {:.1f} % of the picture has a depth, and nothing of it is large enough{}; {}",
      100 * list.survey.known, beyond(list), where);
}

void tell(const List& list, const RangeAllRequest& request) {
  if (!request.csv.empty()) write_csv(list, request.csv);
  if (request.json) {
    print_json(list);
  } else if (!list.surfaces.empty()) {
    print_text(list);
    print_rest(list);
  }
  if (list.surfaces.empty()) note(words_for_none(list));
}

}  // namespace

int range_all(const RangeAllRequest& request) {
  require_sweep_options(request.taking);
  require_separate({request.taking.rig, request.calibration}, {request.csv, request.output});
  Taking taking(request.taking);
  List list;
  if (!request.calibration.empty())
    list.calibration = load_calibration(request.calibration, taking.facts().unit);
  RunKeeper keeper = start_run("range", taking.rig());
  keeper.file.calibration = list.calibration;
  keeper.file.extrapolate = request.extrapolate;
  with_run_file(
      keeper.file, request.output, request.json, [&] { measure(request, taking, keeper, list); },
      [&] { tell(list, request); });
  if (list.was_stopped()) return kError;
  return list.surfaces.empty() ? kNoFocus : kDone;
}

}  // namespace fathom::cli
