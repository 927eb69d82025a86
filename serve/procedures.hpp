// SPDX-License-Identifier: Apache-2.0
// What the service can measure: each from its order to its outcome, on the thread that has the rig.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "engine/error.hpp"
#include "focus/search.hpp"
#include "serve/lent_hardware.hpp"
#include "serve/publisher.hpp"
#include "serve/result_json.hpp"
#include "session/rig.hpp"

namespace fathom::serve {

/// What somebody wants measured.
struct Order {
  Activity kind = Activity::focus;
  std::optional<double> from = {}, to = {}, step = {};
  int frames = 1;                 ///< Of a capture without a travel.
  std::string calibration = {};   ///< Of a range, and of an aim: its name below the folder.
  std::string window = "auto";    ///< Of an aim: what window_wish() takes.
  std::string model = "inverse";  ///< Of a calibration, or "auto".
  std::string name =
      {};  ///< Of what is written: the folder of a capture, the file of a calibration.
};

/// What a calibration is told at each step.
struct NextStep {
  std::optional<double> distance_mm = {};  ///< Of the target now; absent: there is no more.
};

/// All that a measurement works with.
struct Work {
  Order order;
  int id = 0;
  std::int64_t began_ns = 0;
  LentHardware& hardware;
  RigOptions rig;  ///< With the window and the metric that were chosen.
  SearchMethod search = SearchMethod::automatic;
  std::filesystem::path folder;  ///< Below which everything is written.
  Publisher& publisher;
  /// Waits for the next step, and shows pictures meanwhile. Throws Error(cancelled) after a stop.
  std::function<NextStep()> next_step;
};

/// Measures, keeps the run and puts the lens where it belongs. What went wrong is in `error`; then
/// what was measured until then is kept all the same.
struct Ending {
  Outcome outcome = {};
  std::optional<ErrorCode> failure = {};
};
Ending carry_out(Work& work);

/// Where things are kept below the folder of the service.
std::filesystem::path runs_folder(const std::filesystem::path& folder);
std::filesystem::path calibration_file(const std::filesystem::path& folder,
                                       const std::string& name);

/// The calibration of an order. Throws Error(bad_argument) where its positions have another unit, and as
/// Calibration::parse.
Calibration calibration_for(const Work& work, const std::string& unit);

/// The names of the calibrations that are there, in order.
std::vector<std::string> calibrations_in(const std::filesystem::path& folder);

/// Throws Error(bad_argument) for a name that could lead out of a folder: 1 to 64 letters, digits,
/// dots, hyphens and underscores, not beginning with a dot.
void require_plain_name(const std::string& name);

}  // namespace fathom::serve
