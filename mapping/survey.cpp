// SPDX-License-Identifier: Apache-2.0
#include "mapping/survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/placed.hpp"
#include "engine/quantile.hpp"
#include "engine/windowed_metric.hpp"

namespace fathom::mapping {
namespace {

/// Smaller is nearer.
double nearness(const Calibration* calibration, const SeenSurface& surface) {
  if (calibration == nullptr) return -surface.position;
  const double mm = calibration->distance_mm(surface.position);
  return std::isnan(mm) ? std::numeric_limits<double>::infinity() : mm;
}

/// The detail that a surface has in each picture: of the grid's places that are its own, or of the one
/// that its middle lies in.
std::vector<double> detail_of(const Surfaces& all, int number, const CurveGrid& curves) {
  std::vector<double> detail(curves.frames.size());
  bool is_seen = false;
  const auto add = [&](int column, int row) {
    const auto place = static_cast<std::size_t>(row * curves.columns + column);
    for (std::size_t i = 0; i < detail.size(); ++i) detail[i] += curves.frames[i][place];
    is_seen = true;
  };
  for (int row = 0; row < curves.rows; ++row) {
    for (int column = 0; column < curves.columns; ++column) {
      const int x = (2 * column + 1) * all.width_px / (2 * curves.columns);
      const int y = (2 * row + 1) * all.height_px / (2 * curves.rows);
      const int cell = y / all.side_px * all.columns + x / all.side_px;
      if (all.owner[static_cast<std::size_t>(cell)] == number) add(column, row);
    }
  }
  const SeenSurface& surface = all.found[static_cast<std::size_t>(number)];
  if (!is_seen) {
    add(static_cast<int>(surface.centre_x * curves.columns / all.width_px),
        static_cast<int>(surface.centre_y * curves.rows / all.height_px));
  }
  return detail;
}

/// How far values lie from the next ones, the median.
double step_of(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i)
    steps.push_back(std::abs(values[i] - values[i - 1]));
  return steps.empty() ? 0 : median(std::move(steps));
}

/// From a picture to the next one: a gap is no place for a focus.
double spacing_of(std::vector<double> positions) {
  std::ranges::sort(positions);
  return step_of(positions);
}

/// Whether the pictures bear a surface out by themselves, without the law of blur: its detail is
/// greatest near its place, away from both ends and above what it is there. A focus beyond the
/// pictures, or the blur of something bright beside it, looks to the law like one within.
/// spacing: of the positions.
bool is_borne_out(const Surfaces& all, int number, const CurveGrid& curves,
                  const std::vector<double>& positions, double spacing) {
  const std::vector<double> detail = detail_of(all, number, curves);
  const auto [least, greatest] = std::ranges::minmax_element(detail);
  const auto [low, high] = std::ranges::minmax_element(positions);
  const double ends = std::max(detail[static_cast<std::size_t>(low - positions.begin())],
                               detail[static_cast<std::size_t>(high - positions.begin())]);
  constexpr double kAbove = 0.2, kSteps = 2.5, kSpacings = 3, kSpreads = 2;
  const double rise = *greatest - ends;
  if (rise < kAbove * (*greatest - *least) || rise < kSteps * step_of(detail)) return false;
  const SeenSurface& surface = all.found[static_cast<std::size_t>(number)];
  if (surface.position < *low + spacing || surface.position > *high - spacing) return false;
  const double there = positions[static_cast<std::size_t>(greatest - detail.begin())];
  return std::abs(there - surface.position) <= kSpacings * spacing + kSpreads * surface.spread;
}

/// Takes away the surfaces that the pictures do not bear out. Returns how many.
std::size_t leave_out(Surfaces& all, const CurveGrid& curves,
                      const std::vector<double>& positions) {
  const double spacing = spacing_of(positions);
  std::vector<int> numbers;
  std::vector<SeenSurface> kept;
  for (std::size_t i = 0; i < all.found.size(); ++i) {
    const bool is_kept = is_borne_out(all, static_cast<int>(i), curves, positions, spacing);
    numbers.push_back(is_kept ? static_cast<int>(kept.size()) : Surfaces::kNone);
    if (is_kept) kept.push_back(all.found[i]);
  }
  for (int& owner : all.owner) {
    if (owner != Surfaces::kNone) owner = numbers[static_cast<std::size_t>(owner)];
  }
  const std::size_t left_out = all.found.size() - kept.size();
  all.found = std::move(kept);
  return left_out;
}

}  // namespace

double coarse_step(const LensInfo& lens, const FocusLimits& limits) {
  constexpr double kOfCoarsePass = 4, kParts = 48, kFewestParts = 16;
  const double way = limits.to - limits.from;
  const double wanted =
      lens.coarse_spacing > 0 ? lens.coarse_spacing / kOfCoarsePass : way / kParts;
  const double step = std::min(wanted, way / kFewestParts);
  return std::max(std::floor(step / lens.resolution), 1.0) * lens.resolution;
}

Survey survey_of(const DepthResult& result, std::string unit, std::size_t expected) {
  const auto known = std::ranges::count(result.maps.classes, DepthClass::known);
  Surfaces surfaces = find_surfaces(result.maps, &result.sharp.grey);
  const std::size_t left_out = leave_out(surfaces, result.curves, result.positions);
  return {.surfaces = std::move(surfaces),
          .left_out = left_out,
          .sharper = sharper_end(result.curves, result.positions),
          .expected = expected,
          .unit = std::move(unit),
          .positions = result.positions,
          .seen = result.seen,
          .known = static_cast<double>(known) / static_cast<double>(result.pixels())};
}

Window where_sharp(const Survey& survey, const AimedWindow& aimed) {
  const Surfaces& all = survey.surfaces;
  const double sharpest = all.found[static_cast<std::size_t>(aimed.surface)].position;
  const auto nearest = std::ranges::min_element(
      survey.positions, {}, [&](double position) { return std::abs(position - sharpest); });
  const Similarity& place =
      survey.seen[static_cast<std::size_t>(nearest - survey.positions.begin())].place;
  const double half = (aimed.window.n - 1) / 2.0;
  const depth::Point middle = depth::place_of(place, aimed.window.x + half, aimed.window.y + half,
                                              all.width_px, all.height_px);
  const auto corner = [&](double at, int size) {
    return std::clamp(static_cast<int>(std::lround(at - half)), 0, size - aimed.window.n);
  };
  return {corner(middle.x, all.width_px), corner(middle.y, all.height_px), aimed.window.n};
}

KeptSurface kept_of(const Surfaces& surfaces, const SeenSurface& surface) {
  const double pixels = 1.0 * surfaces.width_px * surfaces.height_px;
  return {.position = surface.position,
          .sigma = surface.sigma,
          .relief = surface.relief,
          .x = surface.box.x,
          .y = surface.box.y,
          .width_px = surface.box.width_px,
          .height_px = surface.box.height_px,
          .area = static_cast<double>(surface.area_px) / pixels,
          .texture = surface.texture};
}

std::vector<RangedSurface> ranged(const Surfaces& surfaces, const Calibration* calibration,
                                  bool extrapolate) {
  std::vector<RangedSurface> all;
  for (std::size_t i = 0; i < surfaces.found.size(); ++i) {
    RangedSurface one{.number = i, .distance = {}, .window = {}};
    if (calibration)
      one.distance = distance_of(*calibration, kept_of(surfaces, surfaces.found[i]), extrapolate);
    one.window = roomiest_window(surfaces, kDefaultWindowSide, static_cast<int>(i));
    all.push_back(one);
  }
  std::ranges::stable_sort(all, [&](const RangedSurface& a, const RangedSurface& b) {
    return nearness(calibration, surfaces.found[a.number]) <
           nearness(calibration, surfaces.found[b.number]);
  });
  return all;
}

std::optional<AimedWindow> roomiest_window(const Surfaces& surfaces, int most,
                                           std::optional<int> surface) {
  constexpr int kLeast = 16;
  for (int n = most; n >= kLeast; n /= 2) {
    if (auto window = richest_window(surfaces, n, surface)) return window;
  }
  return std::nullopt;
}

}  // namespace fathom::mapping
