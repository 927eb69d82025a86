// SPDX-License-Identifier: Apache-2.0
// A stepper driver board, a motor and a lens that obey the wires, on a clock that costs no time.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/error.hpp"
#include "hal/drivers/stepper/stepper_lens.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom::test {

/// Time that passes only by sleeping, and by what is added to it. A motion's thread makes it pass
/// while a test looks at it.
class FakeTime final : public stepper::TimeSource {
 public:
  std::int64_t now_ns() override { return now_ns_; }
  void sleep_until_ns(std::int64_t time_ns) override {
    now_ns_ = std::max(now_ns_.load(), time_ns) + late_by_ns_;
  }
  void pass_ns(std::int64_t duration_ns) { now_ns_ += duration_ns; }
  /// How much longer than asked every sleep lasts.
  void be_late_by_ns(std::int64_t late_ns) { late_by_ns_ = late_ns; }

 private:
  std::atomic<std::int64_t> now_ns_ = 1'000'000'000;
  std::int64_t late_by_ns_ = 0;
};

/// One change of a wire's level.
struct Edge {
  std::int64_t time_ns;
  char wire;  ///< 'S' for STEP, 'D' for DIR.
  bool level;
};

/// Where the lens stood from a time on.
struct Stood {
  std::int64_t since_ns;
  int lens;
};

/// Board, motor and lens. Steps at rising edges; DIR high turns upward. The lens has mechanical
/// ends at 0 and `top`, where the motor stalls; going up the lens stands where the rotor does,
/// going down it lags behind by the play. While a motor turns, other threads may ask for lens_at()
/// and mean_lens() only.
struct FakeBoard {
  explicit FakeBoard(stepper::TimeSource& clock) : time(clock) {}

  stepper::TimeSource& time;
  std::vector<Edge> edges;
  std::vector<Stood> trail{{INT64_MIN, 0}};  ///< And an entry for every step that turned the motor.
  bool step_level = false, direction_level = false;
  int rotor = 0, lens = 0, top = 1200, play = 0;
  double stall_rate = 0;  ///< Steps/s above which a step is lost; 0: never.
  int to_lose = 0;        ///< The next steps that are lost.
  int switch_at = -1000;  ///< The lens closes the switch (level low) at or below this.
  bool has_switch = false;
  bool is_stuck = false;  ///< The motor's cable is off.
  int fail_at_step = 0;   ///< The port fails at this step; 0: never.
  int steps = 0;
  std::int64_t write_cost_ns = 2'000;
  std::function<void()> at_every_write = [] {};

  void stand_at(int position) {
    rotor = lens = position;
    trail = {{INT64_MIN, position}};
  }

  /// Where the lens truly was at a time,
  int lens_at(std::int64_t time_ns) const {
    const std::lock_guard lock(mutex);
    return std::prev(later_than(time_ns))->lens;
  }
  /// and on average over an exposure.
  double mean_lens(const Exposure& exposure) const {
    const std::lock_guard lock(mutex);
    const auto first = std::prev(later_than(exposure.start_ns));
    const auto last = std::prev(later_than(exposure.end_ns));
    if (first == last || exposure.end_ns == exposure.start_ns) return first->lens;
    double beyond_first = 0;  // steps times ns
    for (auto stood = std::next(first); stood <= last; ++stood) {
      beyond_first += (stood->lens - std::prev(stood)->lens) *
                      static_cast<double>(exposure.end_ns - stood->since_ns);
    }
    return first->lens + beyond_first / static_cast<double>(exposure.end_ns - exposure.start_ns);
  }

  void write(char wire, bool level) {
    if (wire == 'S' && level && fail_at_step != 0 && steps + 1 == fail_at_step) {
      throw Error(ErrorCode::device_lost, "the port is gone");
    }
    if (auto* fake = dynamic_cast<FakeTime*>(&time)) fake->pass_ns(write_cost_ns);
    {
      const std::lock_guard lock(mutex);
      bool& now = wire == 'S' ? step_level : direction_level;
      if (now != level) edges.push_back({time.now_ns(), wire, level});
      const bool rises = level && !now;
      now = level;
      if (wire == 'S' && rises) step();
    }
    at_every_write();
  }

  /// The times of the steps.
  std::vector<std::int64_t> step_times() const {
    std::vector<std::int64_t> times;
    for (const Edge& edge : edges) {
      if (edge.wire == 'S' && edge.level) times.push_back(edge.time_ns);
    }
    return times;
  }
  /// The shortest time between two steps.
  std::int64_t shortest_interval_ns() const {
    const auto times = step_times();
    std::int64_t shortest = INT64_MAX;
    for (std::size_t i = 1; i < times.size(); ++i) {
      shortest = std::min(shortest, times[i] - times[i - 1]);
    }
    return shortest;
  }

 private:
  std::vector<Stood>::const_iterator later_than(std::int64_t time_ns) const {
    return std::upper_bound(
        trail.begin(), trail.end(), time_ns,
        [](std::int64_t wanted_ns, const Stood& stood) { return wanted_ns < stood.since_ns; });
  }

  void step() {
    ++steps;
    const std::int64_t now = time.now_ns();
    const bool is_too_fast =
        stall_rate > 0 && steps > 1 && static_cast<double>(now - last_step_ns) < 1e9 / stall_rate;
    last_step_ns = now;
    if (is_stuck || is_too_fast) return;
    if (to_lose > 0) {
      --to_lose;
      return;
    }
    const int turned = rotor + (direction_level ? 1 : -1);
    const int dragged = std::clamp(lens, turned, turned + play);
    if (dragged < 0 || dragged > top) return;  // the motor stalls
    rotor = turned;
    lens = dragged;
    trail.push_back({now, lens});
  }

  std::int64_t last_step_ns = 0;
  mutable std::mutex mutex;  // of trail, and of what a write changes
};

class FakeLines final : public stepper::Lines {
 public:
  explicit FakeLines(std::shared_ptr<FakeBoard> board) : board_(std::move(board)) {}
  std::string name() const override { return "fake port"; }
  bool step_at_open() const override { return board_->step_level; }
  void write_step(bool high) override { board_->write('S', high); }
  void write_direction(bool high) override { board_->write('D', high); }
  bool has_home_switch() const override { return board_->has_switch; }
  bool read_home_switch() override { return board_->lens > board_->switch_at; }

 private:
  std::shared_ptr<FakeBoard> board_;
};

using Keys = std::map<std::string, std::string>;

/// A lens on a fake board, with a state file of its own.
struct FakeRig {
  FakeTime time;
  std::shared_ptr<FakeBoard> board = std::make_shared<FakeBoard>(time);
  TemporaryFolder folder;
  stepper::Settings settings;
  int stop_requests = 0;

  /// The keys beside the port.
  explicit FakeRig(Keys keys = {}) {
    keys.emplace("port", "/dev/none");
    keys.emplace("state", (folder / "state.json").string());
    const RigSettings rig("rig", keys);
    settings = stepper::Settings::read(rig);
    rig.require_all_used();
  }

  std::filesystem::path state() const { return settings.state; }

  std::unique_ptr<stepper::StepperLens> open() { return open(time); }
  std::unique_ptr<stepper::StepperLens> open(stepper::TimeSource& clock) {
    return std::make_unique<stepper::StepperLens>(settings, std::make_unique<FakeLines>(board),
                                                  clock, [this] { return stop_requests; });
  }
  /// The same, with the lens at a position that it knows.
  std::unique_ptr<stepper::StepperLens> open_at(int position) {
    board->stand_at(position);
    auto lens = open();
    lens->declare_at(position);
    return lens;
  }
};

}  // namespace fathom::test
