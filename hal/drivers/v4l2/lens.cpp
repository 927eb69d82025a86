// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/lens.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "engine/error.hpp"
#include "hal/approach.hpp"
#include "hal/drivers/v4l2/controls.hpp"

namespace fathom::v4l2 {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
/// The way and the ringing of a webcam's voice coil or gear, with room to spare.
constexpr double kUsualSettle_ms = 300;
/// A camera that reports where its lens is, not where it is sent, may be on its way so long without
/// a new report.
constexpr std::int64_t kSilence_ns = 500 * kMillisecond_ns;
/// No focus takes longer from end to end.
constexpr std::int64_t kLongestWay_ns = 30'000 * kMillisecond_ns;
constexpr std::int64_t kSlice_ns = 20 * kMillisecond_ns;

/// Farther out than any focus goes, and sums of two still fit an int.
constexpr int kFarthest = 1'000'000'000;

bool is_within_reason(std::int32_t position) {
  return position >= -kFarthest && position <= kFarthest;
}

/// Sleeps; false as soon as a stop is asked for.
bool sleep_until(System& system, std::int64_t until_ns, const StopWatch& watch) {
  for (std::int64_t now_ns = system.now_ns(); now_ns < until_ns; now_ns = system.now_ns()) {
    if (watch.stopped()) return false;
    system.sleep_until_ns(std::min(until_ns, now_ns + kSlice_ns));
  }
  return true;
}

class V4l2Lens final : public Lens {
 public:
  V4l2Lens(const std::shared_ptr<Device>& device, Control focus, const LensKeys& keys,
           const StopRequests& stop_requests)
      : device_(device),
        automatic_(device->hold_focus(device)),
        focus_(std::move(focus)),
        keys_(keys),
        stop_requests_(stop_requests) {
    limit_travel();
    stands_ = where_it_stands("");
  }

  LensInfo info() const override {
    LensInfo info;
    info.description = fmt::format("v4l2 {} of {}", focus_.name, device_->path());
    info.unit = "units";
    info.lowest = focus_.lowest;
    info.highest = focus_.highest;
    info.resolution = focus_.step;
    keys_.traits.describe(info);
    return info;
  }

  std::string why_unwatched() const override {
    return "its driver says where the lens was sent, not where it is on the way";
  }

  /// What the device says, so that a lens that somebody else has moved is noticed.
  double position() const override { return read_control(*device_, focus_); }

  Arrival move_to(double position) override {
    require_within(info(), position);
    const auto target = static_cast<int>(nearest(position));
    const StopWatch watch(stop_requests_);
    Arrival arrival;
    arrival.started_ns = device_->system().now_ns();
    notice_others(target);
    // Nobody knows from which side the lens came to where it was found.
    const int from = came_from_below_ ? stands_ : std::max(stands_, target + 1);
    const int takeup = static_cast<int>(
        std::min<double>(std::ceil(keys_.traits.backlash / focus_.step) * focus_.step, kFarthest));
    came_from_below_ = false;
    int next = from;
    for (const int way : approach_moves(from, target, takeup, focus_.lowest)) {
      if (next != from) finish_leg(watch);
      next += way;
      drive(next, watch);
    }
    came_from_below_ = true;
    arrival.stopped_ns = std::max(stopped_ns_, arrival.started_ns);
    settle(watch);
    arrival.settled_ns = device_->system().now_ns();
    arrival.position = stands_;
    return arrival;
  }

  Arrival home() override { return move_to(info().lowest); }

 private:
  void limit_travel() {
    const Control whole = focus_;
    const int lowest = keys_.lowest.value_or(whole.lowest);
    const int highest = keys_.highest.value_or(whole.highest);
    const auto last = whole.nearest(whole.highest);
    // Soft limits lie on positions that the lens can take, and never beyond what was asked for.
    const auto steps_to = [&](int limit) { return static_cast<long long>(limit) - whole.lowest; };
    const long long first_step = (steps_to(lowest) + whole.step - 1) / whole.step;
    const long long last_step = steps_to(std::min(highest, last)) / whole.step;
    if (lowest < whole.lowest || highest > whole.highest || first_step >= last_step) {
      throw Error(
          ErrorCode::unsupported,
          fmt::format("{}: lowest={},highest={} leave no travel within its {} to {} (step {})",
                      device_->path(), lowest, highest, whole.lowest, whole.highest, whole.step));
    }
    focus_.lowest = static_cast<std::int32_t>(whole.lowest + first_step * whole.step);
    focus_.highest = static_cast<std::int32_t>(whole.lowest + last_step * whole.step);
    if (!is_within_reason(focus_.lowest) || !is_within_reason(focus_.highest)) {
      throw Error(ErrorCode::unsupported,
                  fmt::format("{}: its focus goes from {} to {}, it says, which no lens does; set "
                              "lowest and highest to its real travel",
                              device_->path(), focus_.lowest, focus_.highest));
    }
  }

  /// `when`: as read_control. Throws Error(unsupported) for what is no position of a lens.
  int where_it_stands(std::string_view when) const {
    const std::int32_t found = read_control(*device_, focus_, when);
    if (is_within_reason(found)) return found;
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: \"{}\" says that it stands at {}, which is no position of a lens; "
                            "its driver cannot be used",
                            device_->path(), focus_.name, found));
  }

  /// Another program may have moved the lens since; nobody knows from which side.
  void notice_others(int target) {
    const int found = where_it_stands(fmt::format(" before it moves to {}", target));
    if (found == stands_) return;
    stands_ = found;
    came_from_below_ = false;
  }

  /// Sends the lens to a position and waits until it is there.
  void drive(int target, const StopWatch& watch) {
    System& system = device_->system();
    const int from = stands_;
    const std::int64_t started_ns = system.now_ns();
    command(target);
    if (keys_.units_per_s > 0) {
      const double way_ns = std::abs(target - from) / keys_.units_per_s * 1e9;
      if (!sleep_until(system, started_ns + static_cast<std::int64_t>(way_ns), watch)) {
        stop_between(from, target, started_ns);
      }
    }
    stands_ = await_report(target, watch);
    stopped_ns_ = system.now_ns();
  }

  /// Where the speed is not known, nobody says when the way down is over, and the way back must not
  /// begin before that: it would take up nothing.
  void finish_leg(const StopWatch& watch) {
    if (keys_.units_per_s == 0) settle(watch);
  }

  void command(int target) {
    v4l2_control wanted{focus_.id, target};
    device_->call_control(VIDIOC_S_CTRL, wanted,
                          fmt::format("cannot move \"{}\" to {}", focus_.name, target));
    stands_ = target;
  }

  /// Reads back until the device says that the lens is where it was sent, or rests a step beside it.
  /// Most devices say so at once, and some report where the lens is on its way. Returns where it is.
  int await_report(int target, const StopWatch& watch) {
    System& system = device_->system();
    const std::int64_t give_up_ns = system.now_ns() + kLongestWay_ns;
    const auto is_beside = [&](int place) {
      return std::abs(1.0 * place - target) <= accuracy_of(info());
    };
    int reported = read_control(*device_, focus_);
    std::int64_t heard_ns = system.now_ns();
    while (reported != target) {
      const std::int64_t now_ns = system.now_ns();
      const bool is_silent = now_ns - heard_ns >= kSilence_ns;
      if (is_silent && is_beside(reported)) break;
      if (is_silent || now_ns >= give_up_ns) fail_elsewhere(target, reported);
      if (watch.stopped()) {
        command(reported);
        throw_stopped();
      }
      system.sleep_until_ns(now_ns + kSlice_ns);
      const int again = read_control(*device_, focus_);
      if (again != reported) heard_ns = system.now_ns();
      reported = again;
    }
    return reported;
  }

  [[noreturn]] void fail_elsewhere(int target, int reported) {
    stands_ = reported;
    throw Error(
        ErrorCode::device_lost,
        fmt::format("{}: \"{}\" was sent to {} and stands at {}; is it blocked, does another "
                    "program move it, or is its travel shorter than it says (then set lowest "
                    "and highest)?",
                    device_->path(), focus_.name, target, reported));
  }

  /// There is no command to stop a focus; one to go where it is ends its way all the same.
  [[noreturn]] void stop_between(int from, int target, std::int64_t started_ns) {
    const double gone_s = static_cast<double>(device_->system().now_ns() - started_ns) * 1e-9;
    const double gone = std::min(gone_s * keys_.units_per_s, std::abs(1.0 * target - from));
    command(focus_.nearest(target > from ? from + gone : from - gone));
    throw_stopped();
  }

  [[noreturn]] void throw_stopped() const {
    throw Error(ErrorCode::cancelled,
                fmt::format("stopped on request, with \"{}\" at {}", focus_.name, stands_));
  }

  void settle(const StopWatch& watch) {
    System& system = device_->system();
    const std::int64_t settled_ns = stopped_ns_ + keys_.traits.settle_ns();
    if (sleep_until(system, settled_ns, watch)) return;
    // Where the speed is not known, the lens may still be on its way, and must not be left so.
    if (keys_.units_per_s == 0) {
      const auto usual_ns = static_cast<std::int64_t>(kUsualSettle_ms * kMillisecond_ns);
      system.sleep_until_ns(std::min(settled_ns, stopped_ns_ + usual_ns));
    }
    throw_stopped();
  }

  std::shared_ptr<Device> device_;
  std::shared_ptr<ControlGuard> automatic_;
  Control focus_;  ///< With its soft limits.
  LensKeys keys_;
  StopRequests stop_requests_;
  int stands_ = 0;                ///< Where it was sent last, or was found.
  bool came_from_below_ = false;  ///< Whether a move of ours ended there.
  std::int64_t stopped_ns_ = 0;
};

}  // namespace

LensKeys LensKeys::read(const RigSettings& settings) {
  LensTraits usual;
  usual.settle_ms = kUsualSettle_ms;
  LensKeys keys;
  keys.traits = LensTraits::read(settings, usual);
  const auto lowest = static_cast<int>(settings.integer("lowest", 0, -kFarthest, kFarthest));
  if (settings.has("lowest")) keys.lowest = lowest;
  const auto highest = static_cast<int>(settings.integer("highest", 0, -kFarthest, kFarthest));
  if (settings.has("highest")) keys.highest = highest;
  keys.units_per_s = settings.number("speed", 0, 0, kFarthest);
  return keys;
}

std::unique_ptr<Lens> open_lens(const std::shared_ptr<Device>& device, const LensKeys& keys,
                                const StopRequests& stop_requests) {
  auto focus = find_control(*device, V4L2_CID_FOCUS_ABSOLUTE);
  if (!focus || focus->highest - static_cast<long long>(focus->lowest) < focus->step)
    return nullptr;
  return std::make_unique<V4l2Lens>(device, *focus, keys, stop_requests);
}

}  // namespace fathom::v4l2
