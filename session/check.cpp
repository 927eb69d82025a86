// SPDX-License-Identifier: Apache-2.0
#include "session/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "session/saturation.hpp"

namespace fathom {
namespace {

/// Where the focus curve falls, in half-widths from its top: a score there says best where the lens
/// is. A lens that has not quite arrived shows.
constexpr double kSlope = 0.8;

/// A place on the slope of a hill inside of the lens's travel.
double slope_of(const Hill& hill, const LensInfo& lens) {
  const double aside = std::max(kSlope * hill.half_width, lens.resolution);
  const double above = hill.position + aside;
  return above <= lens.highest ? above : hill.position - aside;
}

std::int64_t in_ns(double ms) { return static_cast<std::int64_t>(ms * 1e6); }

void rest_until(Rig& rig, std::int64_t time_ns) {
  take_frame(rig.camera(), time_ns, rig.options().shot);
}

/// Whether the lens ends on the slope of the hill, as one that comes from below must. From above
/// play may keep it away from there.
bool ends_on_slope(const Hill& hill, double from, double to, const Settling& settling) {
  constexpr double kLeast = 0.2;  // of the height; on the slope it is more than half
  return from > to || settling.rest > hill.floor + kLeast * hill.height;
}

/// A move, and how long it should take the lens, if that is known from another one.
struct Way {
  double from = 0, to = 0;
  double expected_ms = 0;
};

/// How a move was watched: the lens rested so long before it, and frames were taken so long after.
struct Watch {
  double rest_ms = 0;
  double watch_ms = 0;
  Settling settling;
};

/// What one move takes; still not at rest where frames change after the longest watch. Before the
/// move the lens rests for longer than it was seen to move: else it may not have been where it came
/// from. A driver that does not wait for its motor is given five seconds at least, and as much again
/// before the next try, so that no two moves run at once.
Watch watch_move(Rig& rig, const Hill& hill, const Way& way, const WatchNews& watching) {
  const double from = way.from, to = way.to;
  constexpr double kDoubtful_ms = 5000, kMargin = 2.2;
  const bool is_doubtful = took_no_time(rig, arrive(rig.lens(), rig.lens().nearest(from)));
  Watch watch;
  const double longest_ms = kLongestWatch_ms * (is_doubtful ? 2 : 1);
  double ms = std::clamp(kMargin * way.expected_ms, kFirstWatch_ms, longest_ms);
  for (; ms <= longest_ms; ms *= is_doubtful ? 4 : 2) {
    const std::int64_t last_ns = watch.settling.ended_ns;
    watch = {is_doubtful ? std::max(ms, kDoubtful_ms) : ms, ms, {}};
    if (watching) watching(from, to, watch.rest_ms + watch.watch_ms);
    if (is_doubtful && last_ns > 0) rest_until(rig, last_ns + in_ns(watch.rest_ms));
    const Settling& settling = watch.settling =
        measure_settling(rig, from, to, watch.rest_ms, watch.watch_ms);
    const bool was_there = 2 * settling.settled_ms <= watch.rest_ms;
    if (settling.is_at_rest && was_there && ends_on_slope(hill, from, to, settling)) return watch;
  }
  watch.settling.is_at_rest = false;
  return watch;
}

/// What is no chance shows again.
Settling settling_twice(Rig& rig, const Hill& hill, const Way& way, const WatchNews& watching) {
  const double from = way.from, to = way.to;
  const Watch once = watch_move(rig, hill, way, watching);
  if (!once.settling.is_at_rest || once.settling.settled_ms == 0) return once.settling;
  if (watching) watching(from, to, once.rest_ms + once.watch_ms);
  const Settling again = measure_settling(rig, from, to, once.rest_ms, once.watch_ms);
  const bool is_less = again.is_at_rest && again.settled_ms < once.settling.settled_ms;
  return is_less && ends_on_slope(hill, from, to, again) ? again : once.settling;
}

/// Where moves to the slope begin: near by on either side, and at an end of the travel, at the
/// lower one if that is far.
std::vector<double> starts_of_moves(const Hill& hill, double slope, const LensInfo& lens) {
  const double near = 4 * hill.half_width;
  std::vector<double> starts{std::max(slope - near, lens.lowest),
                             std::min(slope + near, lens.highest)};
  const bool is_low_far = slope - lens.lowest >= (lens.highest - lens.lowest) / 3;
  const double end = is_low_far ? lens.lowest : lens.highest;
  if (end < starts[0] || end > starts[1]) starts.push_back(end);
  return starts;
}

}  // namespace

CameraCheck check_camera(Rig& rig) {
  constexpr int kFrames = 10;
  CameraCheck check;
  check.repeat_scatter = rig.repeat_scatter(rig.lens().position(), kFrames);
  const Frame first = take_frame(rig.camera(), 0, rig.options().shot);
  Frame last = first.clone();
  for (int i = 1; i < kFrames; ++i) last = take_frame(rig.camera(), 0, rig.options().shot);
  const double span_s =
      1e-9 * static_cast<double>(last.exposure.start_ns - first.exposure.start_ns);
  check.frames_per_s = span_s > 0 ? (kFrames - 1) / span_s : 0;
  check.counts = rig.camera().counts();
  check.saturated = saturated_part(last, rig.window());
  return check;
}

bool has_curve(const Focus& focus) {
  return focus.result() == FocusResult::focused && focus.lobes[0].half_width > 0;
}

std::optional<Lag> measure_lag(Rig& rig, const Hill& hill, const WatchNews& watching) {
  const LensInfo lens = rig.lens().info();
  const double slope = slope_of(hill, lens);
  Lag lag;
  double longest = 0, shortest = 0;  // ways, and what they took at most
  double longest_ms = 0, shortest_ms = 0;
  for (const double from : starts_of_moves(hill, slope, lens)) {
    const double way = std::abs(from - slope);
    const double farther = longest > 0 ? std::max(way / longest, 1.0) : 1;
    const Way move{from, slope, farther * lag.slowest.settled_ms};
    const Settling settling = settling_twice(rig, hill, move, watching);
    if (!settling.is_at_rest) return std::nullopt;
    if (lag.slowest.frames.empty() || settling.settled_ms > lag.slowest.settled_ms) {
      lag.slowest = settling;
      longest = way;
    }
    if (way > 4.5 * hill.half_width) continue;
    if (settling.settled_ms >= shortest_ms) shortest = way;
    shortest_ms = std::max(shortest_ms, settling.settled_ms);
  }
  longest_ms = lag.slowest.settled_ms;
  const bool grows = longest > shortest && longest_ms > shortest_ms + 2 * lag.slowest.interval_ms;
  if (grows) lag.per_unit_ms = (longest_ms - shortest_ms) / (longest - shortest);
  lag.least_ms = grows ? std::max(shortest_ms - lag.per_unit_ms * shortest, 0.0) : longest_ms;
  return lag;
}

double waiting_ms(Rig& rig, const Hill& hill) {
  const Arrival arrival = arrive(rig.lens(), rig.lens().nearest(hill.position));
  return 1e-6 * static_cast<double>(arrival.settled_ns - arrival.stopped_ns);
}

Rig rig_with(const RigOptions& options, const LensSettings& settings) {
  OpenOptions open;
  open.stop_requests = options.shot.stop_requests;
  open.lens_overrides = {{"settle_ms", fmt::format("{}", settings.settle_ms)},
                         {"backlash", fmt::format("{}", settings.backlash)}};
  if (settings.coarse > 0) open.lens_overrides["coarse"] = fmt::format("{}", settings.coarse);
  return Rig(options, open_hardware(options.rig, open));
}

double suggested_settle_ms(const Lag& bare, const LensInfo& lens) {
  constexpr double kLongest_ms = 60'000;                  // that a rig file may say
  const double margin = bare.per_unit_ms > 0 ? 1.05 : 1;  // of what was not seen but computed
  const double rest_ms = margin * bare.after(lens.highest - lens.lowest) + bare.slowest.interval_ms;
  return std::min(std::ceil(rest_ms / 10) * 10, kLongest_ms);
}

double suggested_coarse(const Hill& hill, double resolution) {
  const double width = 2 * hill.half_width;
  return std::max(std::floor(width / resolution) * resolution, resolution);
}

}  // namespace fathom
