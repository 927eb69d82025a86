// SPDX-License-Identifier: Apache-2.0
#include "mapping/window_choice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/windowed_metric.hpp"

namespace fathom::mapping {
namespace {

std::optional<AimedWindow> aim_at(const Surfaces& surfaces, const WindowSide& side,
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

ChosenWindow richest(const Survey& survey, const WindowSide& side) {
  const auto aimed = aim_at(survey.surfaces, side, std::nullopt);
  if (!aimed) return {};
  const Window window = where_sharp(survey, *aimed);
  return {window, fmt::format("window {}: the most texture of one depth, on {}", to_string(window),
                              where(survey, *aimed))};
}

ChosenWindow nearest(const Survey& survey, const WindowSide& side, const Calibration* calibration) {
  std::size_t passed_over = 0;
  for (const RangedSurface& one : ranged(survey.surfaces, calibration, true)) {
    const auto aimed = aim_at(survey.surfaces, side, static_cast<int>(one.number));
    if (!aimed) {
      ++passed_over;
      continue;
    }
    const Window window = where_sharp(survey, *aimed);
    return {window,
            fmt::format("window {}: on the nearest surface{}: {}{}", to_string(window),
                        passed_over > 0 ? " that has room for one" : "", where(survey, *aimed),
                        calibration ? "" : "; the largest position is taken for the nearest")};
  }
  return {};
}

/// What to do where all becomes sharper towards an end of what was looked at.
std::string search_on(TravelEnd end, const Survey& survey, const LookedAt& looked) {
  const auto [least, most] = std::ranges::minmax(survey.positions);
  const bool is_low = end == TravelEnd::low;
  const double at = is_low ? least : most;
  if (is_low ? at > looked.lens.lowest : at < looked.lens.highest)
    return fmt::format("look on with {} {:g} {}", is_low ? looked.below : looked.above, at,
                       looked.lens.unit);
  return looked.is_live ? "that is the lens's own end: move the target, or the camera"
                        : "the recording ends there";
}

}  // namespace

std::optional<WindowWish> window_wish(std::string_view text) {
  if (text == "auto") return WindowWish::richest;
  if (text == "nearest") return WindowWish::nearest;
  return std::nullopt;
}

WindowSide window_side(const std::string& metric) {
  // A metric that names no side takes whatever it is given.
  const int usual = MetricSpec::parse(metric, kDefaultWindowSide).n;
  const int other = MetricSpec::parse(metric, kDefaultWindowSide / 2).n;
  return {usual, usual == other};
}

ChosenWindow choose_window(const Survey& survey, WindowWish wish, const WindowSide& side,
                           const Calibration* calibration) {
  switch (wish) {
    case WindowWish::richest:
      return richest(survey, side);
    case WindowWish::nearest:
      return nearest(survey, side, calibration);
  }
  return {};
}

NoWindow no_window(const Survey& survey, const WindowSide& side, const LookedAt& looked) {
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
                search_on(*survey.sharper, survey, looked))};
  }
  return {.reason =
              fmt::format("no place in {} frames {} shows texture that comes into focus; {}",
                          survey.positions.size(), range,
                          looked.is_live ? "give it more light or texture, or look in another range"
                                         : "record a target with more texture, or more frames")};
}

}  // namespace fathom::mapping
