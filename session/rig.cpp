// SPDX-License-Identifier: Apache-2.0
#include "session/rig.hpp"

#include <fmt/format.h>

#include <cmath>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/windowed_metric.hpp"
#include "focus/noise.hpp"
#include "session/saturation.hpp"

namespace fathom {
namespace {

const RigOptions& checked(const RigOptions& options) {
  if (options.shot.average >= 1) return options;
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("cannot average {} frames; --average takes 1 or more", options.shot.average));
}

}  // namespace

Rig::Rig(const RigOptions& options)
    : Rig(options,
          open_hardware(checked(options).rig, {.stop_requests = options.shot.stop_requests})) {}

Rig::Rig(const RigOptions& options, Hardware hardware)
    : options_(checked(options)), hardware_(std::move(hardware)) {
  const CameraSettings picture = camera().settings();
  const WindowedMetric aim =
      resolve_window(options_.metric, options_.window, picture.width_px, picture.height_px);
  window_ = aim.window;
  selection_ = select_device(all_backends(), options_.backend, aim.spec, 1, options_.device);
  plan_ = selection_.device->plan(aim.spec, 1);
}

Measurement Rig::measure(double position) {
  const Shot shot = shoot(camera(), lens(), position, options_.shot);
  const auto start = std::chrono::steady_clock::now();
  const double value = score(shot.frame);
  const std::chrono::nanoseconds computed = std::chrono::steady_clock::now() - start;
  const Arrival& arrival = shot.arrival;
  // An encoder may say 50.1 of position 50; a search and its replay know only the latter.
  return {lens().nearest(position),
          value,
          arrival.settled_ns,
          shot.frame.exposure,
          arrival.note,
          arrival.started_ns,
          arrival.stopped_ns,
          computed.count(),
          saturated_part(shot.frame, window_)};
}

TimeSpent time_spent(std::span<const Measurement> measurements) {
  TimeSpent spent;
  for (const Measurement& m : measurements) {
    spent.moving += 1e-9 * static_cast<double>(m.stopped_ns - m.started_ns);
    spent.settling += 1e-9 * static_cast<double>(m.settled_ns - m.stopped_ns);
    spent.exposing += 1e-9 * static_cast<double>(m.exposure.end_ns - m.settled_ns);
    spent.computing += 1e-9 * static_cast<double>(m.compute_ns);
  }
  return spent;
}

double Rig::repeat_scatter(double position, int frames) {
  const Arrival arrival = lens().move_to(lens().nearest(position));
  if (!camera().is_live() || frames < 2) return 0;
  std::vector<double> scores;
  for (int i = 0; i < frames; ++i) {
    scores.push_back(score(take_frame(camera(), arrival.settled_ns, options_.shot)));
  }
  return relative_scatter(scores);
}

Objective Rig::objective(std::function<void(const Measurement&)> log) {
  return {[this, log = std::move(log)](double position) {
            const Measurement measurement = measure(position);
            log(measurement);
            return measurement.score;
          },
          [this](double position) { return lens().nearest(position); }};
}

}  // namespace fathom
