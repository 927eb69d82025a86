// SPDX-License-Identifier: Apache-2.0
// How things stand: all that a page needs that is opened now. docs/http.md says what its JSON means.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/travel.hpp"
#include "engine/window.hpp"

namespace fathom::serve {

enum class Activity { live, aim, focus, sweep, range, calibrate, depth, capture, stopping };
/// "live", "focus" and so on.
const char* to_string(Activity activity) noexcept;

struct PointView {
  double position = 0;
  double score = 0;
  std::int64_t from_ms = 0;  ///< Since the measurement began.
};

struct MeasurementView {
  int id = 0;
  Activity kind = Activity::focus;
  std::int64_t began_ns = 0;  ///< CLOCK_MONOTONIC.
  std::vector<PointView> points = {};
  std::size_t positions = 0;  ///< That a sweep takes; 0 for a search.
  double scatter = 0;         ///< Of a score that is measured again, of its value; 0: not known.
  std::vector<std::string> warnings = {};
  std::string result = {};  ///< JSON, or empty.
};

struct CalibrationView {
  struct Point {
    double distance_mm = 0;
    double position = 0;
    double sigma = 0;
  };
  std::vector<double> distances_mm = {};  ///< Asked for, also where no focus was found.
  std::vector<Point> points = {};
  bool is_waiting = false;  ///< For the next distance.
  std::string fit = {};     ///< JSON, or empty.
};

struct State {
  std::string version = {};
  std::string rig = {};
  std::string description = {};
  bool is_read_only = false;
  int width_px = 0, height_px = 0;
  int most_grey = 255;
  bool is_streaming = false;  ///< Whether frames come by themselves.
  bool has_stage = false;     ///< Whether the rig places its target itself.
  LensInfo lens = {};
  std::optional<double> position = {};  ///< Of the lens; absent where nobody knows.
  bool is_moving = false;
  std::string metric = {};
  std::string search = {};
  std::vector<Window> windows = {};
  Activity activity = Activity::live;
  std::string problem = {};                    ///< What is wrong with the rig now, or empty.
  std::vector<std::string> calibrations = {};  ///< Names of those that a range may use.
  std::optional<MeasurementView> measurement = {};
  std::optional<CalibrationView> calibration = {};
  std::string map = {};  ///< Of the last depth, as JSON, or empty.
};

/// The members of its JSON, without the braces and without what depends on who asks.
std::string state_members(const State& state);

/// A state that several threads look at.
class Board {
 public:
  State copy() const {
    const std::lock_guard lock(mutex_);
    return state_;
  }
  /// What a function makes of it.
  template <typename Read>
  auto read(const Read& look) const {
    const std::lock_guard lock(mutex_);
    return look(state_);
  }
  /// Changes it, and nobody is told.
  void change(const std::function<void(State&)>& change) {
    const std::lock_guard lock(mutex_);
    change(state_);
  }

 private:
  mutable std::mutex mutex_;
  State state_;
};

}  // namespace fathom::serve
