// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/aiming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/windowed_metric.hpp"
#include "tools/fathom/console.hpp"
#include "tools/fathom/depth/survey.hpp"
#include "tools/fathom/run_keeping.hpp"
#include "tools/fathom/verbs.hpp"

namespace fathom::cli {
namespace {

constexpr const char* kAuto = "auto";
constexpr const char* kNearest = "nearest";

/// Side of a window: what the metric says, which then must be; else the usual one, or less.
struct Side {
  int n = kDefaultWindowSide;
  bool must_be = false;
};

Side side_of(const std::string& metric) {
  // A metric that names no side takes whatever it is given.
  const int usual = MetricSpec::parse(metric, kDefaultWindowSide).n;
  const int other = MetricSpec::parse(metric, kDefaultWindowSide / 2).n;
  return {usual, usual == other};
}

std::optional<AimedWindow> aim_at(const Surfaces& surfaces, const Side& side,
                                  std::optional<int> surface) {
  return side.must_be ? richest_window(surfaces, side.n, surface)
                      : roomiest_window(surfaces, side.n, surface);
}

std::string where(const Survey& survey, const AimedWindow& aimed) {
  const SeenSurface& surface = survey.surfaces.found[static_cast<std::size_t>(aimed.surface)];
  return fmt::format("a surface at {:.4g} {} with {:.0f} % of the picture, one of {} in {} frames",
                     surface.position, survey.unit,
                     100.0 * static_cast<double>(surface.area_px) / survey.surfaces.width_px /
                         survey.surfaces.height_px,
                     survey.surfaces.found.size(), survey.positions.size());
}

std::optional<Window> richest(const Survey& survey, const Side& side) {
  const auto aimed = aim_at(survey.surfaces, side, std::nullopt);
  if (!aimed) return std::nullopt;
  const Window window = where_sharp(survey, *aimed);
  note(fmt::format("window {}: the most texture of one depth, on {}", to_string(window),
                   where(survey, *aimed)));
  return window;
}

std::optional<Window> nearest(const Survey& survey, const Side& side,
                              const Calibration* calibration) {
  std::size_t passed_over = 0;
  for (const RangedSurface& one : ranged(survey.surfaces, calibration, true)) {
    const auto aimed = aim_at(survey.surfaces, side, static_cast<int>(one.number));
    if (!aimed) {
      ++passed_over;
      continue;
    }
    const Window window = where_sharp(survey, *aimed);
    note(fmt::format("window {}: on the nearest surface{}: {}{}", to_string(window),
                     passed_over > 0 ? " that has room for one" : "", where(survey, *aimed),
                     calibration ? "" : "; the largest position is taken for the nearest"));
    return window;
  }
  return std::nullopt;
}

/// What to do where all becomes sharper towards an end of what was looked at.
std::string search_on(TravelEnd end, const Survey& survey, Rig& rig) {
  const LensInfo lens = rig.lens().info();
  const auto [least, most] = std::ranges::minmax(survey.positions);
  const bool is_low = end == TravelEnd::low;
  const double at = is_low ? least : most;
  if (is_low ? at > lens.lowest : at < lens.highest)
    return fmt::format("look on with {} {:g} {}", is_low ? "--from below" : "--to above", at,
                       lens.unit);
  return rig.camera().is_live() ? "that is the lens's own end: move the target, or the camera"
                                : "the recording ends there";
}

/// Why there is nothing to aim at.
struct NoWindow {
  FocusResult result = FocusResult::no_focus;
  std::string reason;
};

NoWindow explained(const Survey& survey, const Side& side, Rig& rig) {
  const auto [least, most] = std::ranges::minmax(survey.positions);
  const std::size_t found = survey.surfaces.found.size();
  if (found > 0) {
    return {.reason =
                fmt::format("none of {} surface{} has room for a window of {} px of one depth; {}",
                            found, found == 1 ? "" : "s", side.n,
                            side.must_be ? "name a metric of a smaller one" : "name a window")};
  }
  const std::string range = fmt::format("from {:g} to {:g} {}", least, most, survey.unit);
  if (survey.sharper) {
    return {.result = FocusResult::at_limit,
            .reason = fmt::format(
                "nothing is in focus {}, and the picture becomes sharper towards {:g}: {}", range,
                *survey.sharper == TravelEnd::low ? least : most,
                search_on(*survey.sharper, survey, rig))};
  }
  return {.reason = fmt::format("no place in {} frames {} shows texture that comes into focus; {}",
                                survey.positions.size(), range,
                                rig.camera().is_live()
                                    ? "give it more light or texture, or look in another range"
                                    : "record a target with more texture, or more frames")};
}

TakingRequest look_round(const AimRequest& request) {
  return {.rig = request.rig.rig,
          .from = request.from,
          .to = request.to,
          .step = {},
          .is_coarse = true,
          .average = request.rig.average,
          .is_quiet = true,
          .needs_all = true};
}

/// Looks round. What was measured is kept where that fails.
Survey look(const AimRequest& request, Taking& taking, RunKeeper& keeper) {
  const MetricArguments& metric = request.rig.metric;
  const OpenDevice open = [&](const MetricSpec& spec, std::size_t windows) {
    return select_device(all_backends(), metric.backend, spec, windows, metric.device);
  };
  std::optional<BlurModel> blur = request.blur;
  if (!blur && request.calibration) blur = request.calibration->conditions().blur;
  try {
    return survey(taking, "looking round", open, blur, keeper);
  } catch (const Error&) {
    const auto again = [problem = std::current_exception()] { std::rethrow_exception(problem); };
    with_run_file(keeper.file, request.rig.output, request.rig.json, again, [] {});
    throw;
  }
}

void tell(const NoWindow& none, const AimRequest& request) {
  if (!request.rig.json)
    return print_line(fmt::format("{}: {}", to_string(none.result), none.reason));
  JsonLine line;
  line.add("result", to_string(none.result));
  for (const char* const member : request.unmeasured) line.add_null(member);
  print_line(line.add("reason", none.reason).text());
  note(none.reason);
}

}  // namespace

bool chooses_window(const RigArguments& rig) {
  return rig.metric.window == kAuto || rig.metric.window == kNearest;
}

std::optional<Rig> aimed_rig(const AimRequest& request) {
  if (!chooses_window(request.rig)) return std::optional<Rig>(std::in_place, request.rig.options());
  RigArguments without = request.rig;
  without.metric.window.clear();
  RigOptions options = without.options();
  const Side side = side_of(options.metric);
  Taking taking(look_round(request));
  RunKeeper keeper = start_run(request.verb, taking.rig());
  const Survey seen = look(request, taking, keeper);
  options.window = request.rig.metric.window == kAuto ? richest(seen, side)
                                                      : nearest(seen, side, request.calibration);
  if (options.window)
    return std::optional<Rig>(std::in_place, options, std::move(taking).release_rig().release());
  const NoWindow none = explained(seen, side, taking.rig());
  with_run_file(
      keeper.file, request.rig.output, request.rig.json, [] {}, [&] { tell(none, request); });
  return std::nullopt;
}

}  // namespace fathom::cli
