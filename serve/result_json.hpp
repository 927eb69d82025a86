// SPDX-License-Identifier: Apache-2.0
// What a measurement came to, as a page shows it. docs/http.md says what it means.
#pragma once

#include <optional>
#include <string>

#include "calibration/calibration.hpp"
#include "engine/travel.hpp"
#include "engine/window.hpp"
#include "focus/focus.hpp"
#include "session/run.hpp"

namespace fathom::serve {

/// What is known in the end; any of it may be missing.
struct Outcome {
  std::optional<Focus> focus = {};
  std::optional<Evaluation> best = {};  ///< Of a sweep, which has no focus.
  std::optional<Distance> distance = {};
  std::optional<Window> window = {};  ///< That an aim has found.
  std::string words = {};             ///< In place of the verdict's, where there is none.
  std::string error = {};
  std::string run = {};     ///< The id of its run file, or empty.
  std::string folder = {};  ///< What was written, below the folder of the service, or empty.
};

std::string result_json(const Outcome& outcome, const LensInfo& lens);

/// The curve with its points, parameters and residuals.
std::string fit_json(const Calibration& calibration, const std::string& name);

}  // namespace fathom::serve
