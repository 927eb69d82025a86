// SPDX-License-Identifier: Apache-2.0
// What requests say, read strictly: whatever is not asked for is refused by name. Each throws
// Error(bad_argument) for anything else than it wants. An empty body is an empty object.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/window.hpp"
#include "serve/procedures.hpp"

namespace fathom::serve {

/// {"windows":[{"x":..,"y":..,"n":..}]}
std::vector<Window> windows_from(std::string_view body);

/// {"position":..} or {"by":..}, one of them.
struct LensWish {
  std::optional<double> position, by;
};
LensWish lens_wish_from(std::string_view body);

/// {"metric":..,"search":..}, one of them at least.
struct MethodWish {
  std::optional<std::string> metric, search;
};
MethodWish method_wish_from(std::string_view body);

/// What each kind takes: aim window, from, to and calibration; sweep, depth and focus from, to, and all but the last step; range
/// calibration; calibrate model and name; capture frames, or from, to and step.
Order order_from(Activity kind, std::string_view body);

/// {"distance":..}, mm.
NextStep next_step_from(std::string_view body);

/// {"distance":..}, mm, of any sign.
double distance_from(std::string_view body);

/// {"position":..}, or {"home":true} for none.
std::optional<double> move_from(std::string_view body);

/// {"action":"ask"}, "take", "give" or "refuse".
std::string action_from(std::string_view body);

/// {} for those that want nothing.
void nothing_from(std::string_view body);

/// A number of the query, such as fps=30; `fallback` where the text is empty.
double number_from(std::string_view name, std::string_view text, double fallback, double lowest,
                   double highest);

}  // namespace fathom::serve
