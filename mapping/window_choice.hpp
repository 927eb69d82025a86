// SPDX-License-Identifier: Apache-2.0
// Which window is measured where nobody says it: where most texture of one depth is, or on the nearest
// surface.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "calibration/calibration.hpp"
#include "focus/verdict.hpp"
#include "mapping/survey.hpp"

namespace fathom::mapping {

enum class WindowWish { richest, nearest };
/// "auto" and "nearest"; nothing for any other text.
std::optional<WindowWish> window_wish(std::string_view text);

/// Side of a window: what the metric says, which then must be; else the usual one, or less.
struct WindowSide {
  int n = 0;
  bool must_be = false;
};
/// Throws as MetricSpec::parse.
WindowSide window_side(const std::string& metric);

struct ChosenWindow {
  std::optional<Window> window = {};
  std::string words = {};  ///< Which window, and why.
};
/// calibration: says which way is near; may be null.
ChosenWindow choose_window(const Survey& survey, WindowWish wish, const WindowSide& side,
                           const Calibration* calibration);

/// Why there is nothing to aim at.
struct NoWindow {
  FocusResult result = FocusResult::no_focus;
  std::string reason;
};
/// What was looked at, and with what words somebody looks on.
struct LookedAt {
  const LensInfo& lens;
  bool is_live = true;
  std::string_view below, above;  ///< As "--from below".
};
NoWindow no_window(const Survey& survey, const WindowSide& side, const LookedAt& looked);

}  // namespace fathom::mapping
