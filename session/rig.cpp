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
      fmt::format("cannot average {} frames; an average is of 1 or more", options.shot.average));
}

/// A focus curve has one number at each position.
void require_one_number(const MetricSpec& spec) {
  if (spec.outputs() == 1) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("metric {} gives {} numbers for each window, and a focus is looked for "
                          "by one",
                          spec.text(), spec.outputs()));
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
  require_one_number(aim.spec);
  scorer_.emplace(select_device(all_backends(), options_.backend, aim.spec, 1, options_.device),
                  aim.spec, aim.window);
}

Measurement Rig::measure(double position, const FrameSeen& seen) {
  const Shot shot = shoot(camera(), lens(), position, options_.shot);
  const auto start = std::chrono::steady_clock::now();
  const double value = score(shot.frame);
  const std::chrono::nanoseconds computed = std::chrono::steady_clock::now() - start;
  const Arrival& arrival = shot.arrival;
  seen(shot.frame, arrival, value);
  // An encoder may say 50.1 of position 50; a search and its rerun know only the latter.
  return {.position = lens().nearest(position),
          .score = value,
          .started_ns = arrival.started_ns,
          .stopped_ns = arrival.stopped_ns,
          .settled_ns = arrival.settled_ns,
          .exposure = shot.frame.exposure,
          .compute_ns = computed.count(),
          .saturated = saturated_part(shot.frame, window()),
          .note = arrival.note};
}

double Rig::repeat_scatter(double position, int frames, const FrameSeen& seen) {
  return repeat_scatter(arrive(lens(), lens().nearest(position)), frames, seen);
}

double Rig::repeat_scatter(const Arrival& arrival, int frames, const FrameSeen& seen) {
  if (!camera().is_live() || frames < 2) return 0;
  std::vector<double> scores;
  for (int i = 0; i < frames; ++i) {
    const Frame frame = take_frame(camera(), arrival.settled_ns, options_.shot);
    scores.push_back(score(frame));
    seen(frame, arrival, scores.back());
  }
  return relative_scatter(scores);
}

}  // namespace fathom
