// SPDX-License-Identifier: Apache-2.0
// What is done to a search: nothing at all, or one of the things that happen to real ones.
#pragma once

#include <functional>
#include <optional>
#include <random>
#include <span>
#include <string>

#include "engine/window.hpp"
#include "focus/focus.hpp"
#include "hal/rig_driver.hpp"

namespace fathom::honesty {

/// One random run.
struct Scene {
  Hardware hardware;
  std::string metric;
  std::optional<Window> window;
  FocusRequest request;
  std::string text;  ///< To run it again by hand.
  /// Where the focus is when the search has ended, in the lens's unit; asked for then. Nothing
  /// where there is none.
  std::function<std::optional<double>()> truth;
  double wrong = 0;  ///< An answer that is farther off than this is wrong.
};

struct Kind {
  const char* name;
  /// Whether sigma is judged by the truth, too: where nothing disturbs.
  bool judges_sigma;
  /// Whether pictures can tell that something is wrong. A motor that lost steps once, and not since,
  /// shows the same pictures as one that never did.
  bool is_told;
  Scene (*make)(std::mt19937& random, const std::string& metric);
  /// Where pictures tell half: wrong answers that are less confident than this pass a check.
  double passes_below = 0;
};
std::span<const Kind> kinds();

}  // namespace fathom::honesty
