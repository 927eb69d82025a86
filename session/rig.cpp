// SPDX-License-Identifier: Apache-2.0
#include "session/rig.hpp"

#include <fmt/format.h>

#include <cmath>

#include "backends/backends.hpp"
#include "engine/error.hpp"
#include "engine/windowed_metric.hpp"
#include "focus/noise.hpp"
#include "session/cells.hpp"
#include "session/one_number.hpp"

namespace fathom {
namespace {

const RigOptions& checked(const RigOptions& options) {
  if (options.shot.average >= 1) return options;
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("cannot average {} frames; an average is of 1 or more", options.shot.average));
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
  Device& device = *scorer_->selection().device;
  share_.emplace(device, aim.spec);
  reader_.emplace(device, aim.spec, aim.window);
  rings_.emplace(aim.window, picture.width_px, picture.height_px);
}

Measurement Rig::measure(double position, const FrameSeen& seen) {
  const Shot shot = shoot(camera(), lens(), position, options_.shot);
  Measurement made = read(shot.frame, shot.arrival, seen);
  // An encoder may say 50.1 of position 50; a search and its rerun know only the latter.
  made.position = lens().nearest(position);
  made.frames = camera().is_live() ? options_.shot.average : camera().recorded_here();
  return made;
}

Passage Rig::measure_passing(double to, std::int64_t since_ns, const PassingRules& rules,
                             const std::function<bool(Measurement)>& made, const FrameSeen& seen) {
  const auto passed = [&](const Frame& frame, const Arrival& arrival, const Where& where) {
    Measurement one = read(frame, arrival, seen);
    one.on_the_way = OnTheWay{where.sigma, where.smear};
    return made(std::move(one));
  };
  return take_passing(camera(), lens(), to, since_ns, rules, options_.shot, passed);
}

Measurement Rig::read(const Frame& frame, const Arrival& arrival, const FrameSeen& seen) {
  const auto start = std::chrono::steady_clock::now();
  const double value = score(frame);
  const std::chrono::nanoseconds computed = std::chrono::steady_clock::now() - start;
  seen(frame, arrival, value);
  PictureFacts facts = reader_->read(frame);
  facts.rings = rings_->read(frame);
  if (looks_round_) facts.cells = cells_round(frame, window());
  return {.position = arrival.position,
          .score = value,
          .brightness_share = share_->of(frame, window()),
          .started_ns = arrival.started_ns,
          .stopped_ns = arrival.stopped_ns,
          .settled_ns = arrival.settled_ns,
          .exposure = frame.exposure,
          .compute_ns = computed.count(),
          .picture = std::move(facts),
          .note = arrival.note};
}

std::optional<BlurModel> Rig::blur() {
  const std::optional<double> told = lens().info().blur_px_per_unit;
  if (!told) return std::nullopt;
  return BlurModel{.px_per_unit = *told};
}

double Rig::repeat_scatter(double position, int frames, const FrameSeen& seen) {
  return repeat_scatter(arrive(lens(), lens().nearest(position)), frames, seen);
}

double Rig::recorded_scatter(double from, double to, const FrameSeen& seen) {
  // As many as make the scatter known to a quarter or so; a search reads few pictures more.
  constexpr int kEnough = 3 * kRepeatFrames;
  double squares = 0;
  int freedom = 0;
  if (camera().is_live()) return 0;
  for (const double stop : lens().info().stops) {
    if (stop < from || stop > to) continue;
    if (options_.shot.stop_requests() > 0) throw Error(ErrorCode::cancelled, "stopped on request");
    const Arrival arrival = arrive(lens(), stop);
    const int count = camera().recorded_here();
    if (count < 2) continue;
    std::vector<double> scores;
    for (int i = 0; i < count; ++i) {
      const Frame frame = take_one(camera(), arrival.settled_ns, options_.shot);
      const double value = score(frame);
      scores.push_back(bare(value, frame));
      seen(frame, arrival, value);
    }
    const double scatter = relative_scatter(scores);
    squares += (count - 1) * scatter * scatter / count;
    freedom += count - 1;
    if (freedom >= kEnough) break;
  }
  return freedom > 0 ? std::sqrt(squares / freedom) : 0;
}

double Rig::repeat_scatter(const Arrival& arrival, int frames, const FrameSeen& seen) {
  if (!camera().is_live() || frames < 2) return 0;
  std::vector<double> scores;
  for (int i = 0; i < frames; ++i) {
    const Frame frame = take_frame(camera(), arrival.settled_ns, options_.shot);
    const double value = score(frame);
    scores.push_back(bare(value, frame));
    seen(frame, arrival, value);
  }
  return relative_scatter(scores);
}

}  // namespace fathom
