// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/measuring.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <thread>

#include "backends/backends.hpp"
#include "engine/optics.hpp"
#include "engine/windowed_metric.hpp"
#include "hal/drivers/simulated/thin_lens.hpp"
#include "session/session.hpp"

namespace fathom::reproduce {

RigOptions options_of(const RigChoice& choice, const ShouldStop& should_stop) {
  RigOptions options;
  options.rig = fmt::format("sim:target={},seed={}{}", choice.target, choice.seed, choice.more);
  options.metric = choice.metric;
  options.window = choice.window;
  options.shot.average = choice.average;
  if (should_stop) options.shot.stop_requests = [should_stop] { return should_stop() ? 1 : 0; };
  return options;
}

Run focus_run(Rig& rig, double distance_mm, const FocusRequest& request) {
  // A target that is placed is drawn again, which takes longer than the search.
  if (rig.stage()->distance_mm() != distance_mm) rig.stage()->place_at(distance_mm);
  Observer nobody;
  const Focus focus = *Session(rig).focus(request, nobody).focus;
  return {.distance_mm = distance_mm,
          .result = focus.result(),
          .position = focus.position(),
          .sigma = focus.peak.sigma,
          .evaluations = static_cast<int>(focus.evaluations.size())};
}

FocusRequest thesis_request(double distance_mm, Dice& dice, SearchMethod search) {
  constexpr double kLeast = 20, kMost = 120;
  const double focus = true_position(distance_mm);
  const double low = std::max(std::round(focus - dice.between(kLeast, kMost)), 0.0);
  const double high =
      std::min(std::round(focus + dice.between(kLeast, kMost)), double{simulated::kTravelSteps});
  FocusRequest request = FocusRequest::within(low, high);
  const Bracket whole = whole_range(low, high);
  request.bracket = Bracket{low, std::round(whole.inner), high};
  request.search = search;
  request.peak = PeakMethod::evaluated;
  return request;
}

ThreeScores::ThreeScores(const RigChoice& choice, const ShouldStop& should_stop)
    : options_(options_of(choice, should_stop)), hardware_(open_hardware(options_.rig)) {
  const CameraSettings camera = hardware_.camera->settings();
  for (std::size_t i = 0; i < kTransformCount; ++i) {
    const WindowedMetric metric =
        resolve_window(kTransforms[i].metric, options_.window, camera.width_px, camera.height_px);
    window_ = metric.window;
    selections_[i] = select_device(all_backends(), "", metric.spec, 1);
    plans_[i] = selections_[i].device->plan(metric.spec, 1);
  }
}

std::array<double, kTransformCount> ThreeScores::at(double position) {
  const Shot shot = shoot(*hardware_.camera, *hardware_.lens, position, options_.shot);
  std::array<double, kTransformCount> scores{};
  for (std::size_t i = 0; i < kTransformCount; ++i) {
    scores[i] = plans_[i]->score(shot.frame, window_);
  }
  return scores;
}

double true_position(double distance_mm) { return simulated::focused_position_steps(distance_mm); }

double half_depth_mm(double distance_mm) {
  const Optics optics{simulated::kFocalLengthMm, 4, simulated::kPitchMm};
  return optics::depth_of_field(optics, distance_mm).total_mm() / 2;
}

void run_all(const Tasks& tasks, const std::function<void(std::size_t, std::size_t)>& on_done) {
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i; (i = next++) < tasks.size();) {
      try {
        tasks[i]();
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = tasks.size();
        return;
      }
      const std::lock_guard lock(mutex);
      on_done(++done, tasks.size());
    }
  };
  {
    std::vector<std::jthread> threads;
    const std::size_t count =
        std::min<std::size_t>(std::max(1u, std::thread::hardware_concurrency()), tasks.size());
    for (std::size_t i = 0; i < count; ++i) threads.emplace_back(work);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace fathom::reproduce
