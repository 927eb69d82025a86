// SPDX-License-Identifier: Apache-2.0
#include "session/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "session/saturation.hpp"

namespace fathom {
namespace {

/// Where the focus curve falls, in half-widths from its top: a score there says best where the lens
/// is. A lens that has not quite arrived shows.
constexpr double kSlope = 0.8;
/// What a sweep round the focus covers to either side, in half-widths.
constexpr double kReach = 2;

double half_width_of(const Focus& focus) { return focus.lobes[0].half_width; }

/// A place on the slope of the curve inside of the lens's travel, and the end of the travel that is
/// further away.
struct Slope {
  double place, far_end;
};
Slope slope_of(const Focus& focus, const LensInfo& lens) {
  const double aside = std::max(kSlope * half_width_of(focus), lens.resolution);
  const double above = focus.position() + aside;
  const double place = above <= lens.highest ? above : focus.position() - aside;
  return {place, place - lens.lowest > lens.highest - place ? lens.lowest : lens.highest};
}

/// What one move takes; still not at rest where frames change after the longest watch.
Settling settling_of(Rig& rig, double from, double to, double rest_ms) {
  Settling settling;
  for (double watch_ms = kFirstWatch_ms; watch_ms <= kLongestWatch_ms; watch_ms *= 2) {
    settling = measure_settling(rig, from, to, rest_ms, watch_ms);
    if (settling.is_at_rest) break;
  }
  return settling;
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
  return focus.result() == FocusResult::focused && half_width_of(focus) > 0;
}

std::optional<Settling> slowest_settling(Rig& rig, const Focus& focus, double rest_ms) {
  const LensInfo lens = rig.lens().info();
  const Slope slope = slope_of(focus, lens);
  const double near = 4 * half_width_of(focus);
  std::optional<Settling> slowest;
  for (const double from : {slope.far_end, std::max(slope.place - near, lens.lowest),
                            std::min(slope.place + near, lens.highest)}) {
    Settling settling = settling_of(rig, from, slope.place, rest_ms);
    if (settling.is_at_rest && settling.settled_ms > 0) {  // what is no chance shows again
      const Settling again = settling_of(rig, from, slope.place, rest_ms);
      if (again.is_at_rest && again.settled_ms < settling.settled_ms) settling = again;
    }
    if (!settling.is_at_rest) return std::nullopt;
    if (!slowest || settling.settled_ms > slowest->settled_ms) slowest = settling;
  }
  return slowest;
}

double waiting_ms(Rig& rig, const Focus& focus) {
  const Arrival arrival = arrive(rig.lens(), rig.lens().nearest(focus.position()));
  return 1e-6 * static_cast<double>(arrival.settled_ns - arrival.stopped_ns);
}

Backlash backlash_round(Rig& rig, const Focus& focus) {
  const double reach = std::max(kReach * half_width_of(focus), 6 * rig.lens().info().resolution);
  return measure_backlash(rig, focus.position(), reach, focus.floor, 0);
}

Rig bare_rig(const RigOptions& options, double settle_ms) {
  OpenOptions open;
  open.stop_requests = options.shot.stop_requests;
  open.lens_overrides = {{"settle_ms", fmt::format("{}", settle_ms)}, {"backlash", "0"}};
  return Rig(options, open_hardware(options.rig, open));
}

double suggested_settle_ms(const Settling& bare) {
  return std::ceil((bare.settled_ms + bare.interval_ms) / 10) * 10;
}

double suggested_coarse(const Focus& focus, double resolution) {
  const double width = 2 * half_width_of(focus);
  return std::max(std::floor(width / resolution) * resolution, resolution);
}

}  // namespace fathom
