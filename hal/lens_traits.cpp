// SPDX-License-Identifier: Apache-2.0
#include "hal/lens_traits.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr double kLongestSettle_ms = 60'000;
constexpr double kFarthest = 1e9;  // no lens has more steps

std::optional<Optics> read_optics(const RigSettings& settings) {
  const bool has_focal = settings.has("focal_mm"), has_stop = settings.has("f_number"),
             has_circle = settings.has("circle_um");
  const double focal_mm = settings.number("focal_mm", 0, 0.01, 100'000);
  const double f_number = settings.number("f_number", 0, 0.1, 1000);
  const double circle_um = settings.number("circle_um", 0, 0.01, 100'000);
  if (!has_focal && !has_stop && !has_circle) return std::nullopt;
  if (!has_focal || !has_stop || !has_circle) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: a depth of field needs focal_mm, f_number and circle_um (the "
                            "camera's pixel pitch will do), all three",
                            settings.where()));
  }
  const Optics optics{focal_mm, f_number, circle_um / 1000};
  optics::require_valid(optics);
  return optics;
}

}  // namespace

LensTraits LensTraits::read(const RigSettings& settings, const LensTraits& usual) {
  LensTraits traits;
  traits.settle_ms = settings.number("settle_ms", usual.settle_ms, 0, kLongestSettle_ms);
  traits.backlash = settings.number("backlash", usual.backlash, 0, kFarthest);
  traits.coarse_spacing = settings.number("coarse", usual.coarse_spacing, 0, kFarthest);
  if (settings.has("blur_px")) traits.blur_px = settings.number("blur_px", 0, 1e-6, 1e4);
  traits.optics = read_optics(settings);
  return traits;
}

void LensTraits::describe(LensInfo& info) const {
  info.coarse_spacing =
      coarse_spacing == 0 ? 0
                          : std::clamp(coarse_spacing, info.resolution, info.highest - info.lowest);
  info.optics = optics;
  info.blur_px_per_unit = blur_px;
}

}  // namespace fathom
