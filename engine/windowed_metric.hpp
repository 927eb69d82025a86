// SPDX-License-Identifier: Apache-2.0
// A metric and the window that it is measured in, made to agree.
#pragma once

#include <optional>
#include <string_view>

#include "metric.hpp"
#include "window.hpp"

namespace fathom {

inline constexpr int kDefaultWindowSide = 64;

/// A metric and the window it is taken of.
struct WindowedMetric {
  MetricSpec spec;
  Window window;
};

/// What a user's --metric and --window mean on a picture of this size: N defaults to the window's
/// side, the window to N x N at the centre, N without either to 64. Throws Error(bad_argument)
/// where both name a side and differ, or as MetricSpec::parse; Error(out_of_bounds) as
/// require_fits.
WindowedMetric resolve_window(std::string_view metric, const std::optional<Window>& window,
                              int width_px, int height_px);

}  // namespace fathom
