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
#include "hal/drivers/simulated/thin_lens.hpp"

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

FocusRun focus_run(Rig& rig, double distance_mm, const FocusRequest& request) {
  // A target that is placed is drawn again, which takes longer than the search.
  if (rig.stage()->distance_mm() != distance_mm) rig.stage()->place_at(distance_mm);
  Observer nobody;
  const double start = rig.lens().position();
  const Run run = Session(rig).focus(request, nobody);
  const Focus& focus = *run.focus;
  const Journey journey = journey_of(run);
  return {.distance_mm = distance_mm,
          .result = focus.result(),
          .position = focus.position(),
          .sigma = focus.peak.sigma,
          .evaluations = static_cast<int>(focus.evaluations.size()),
          .start = start,
          .travel = journey.travel,
          .rig_seconds = journey.rig_seconds,
          .frames = journey.frames};
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

namespace {

RigOptions with_first_transform(const RigChoice& choice, const ShouldStop& should_stop) {
  RigOptions options = options_of(choice, should_stop);
  options.metric = kTransforms[0].metric;
  return options;
}

}  // namespace

ThreeScores::ThreeScores(const RigChoice& choice, const ShouldStop& should_stop)
    : rig_(with_first_transform(choice, should_stop)) {
  for (std::size_t i = 1; i < kTransformCount; ++i) {
    const MetricSpec spec = MetricSpec::parse(kTransforms[i].metric, rig_.window().n);
    others_.emplace_back(select_device(all_backends(), "", spec, 1), spec, rig_.window());
  }
}

std::array<double, kTransformCount> ThreeScores::at(double position) {
  Session(rig_).visit({position}, *this);
  return scores_;
}

void ThreeScores::frame(const Frame& frame, const Arrival&, std::span<const double> scores) {
  scores_[0] = scores[0];
  for (std::size_t i = 1; i < kTransformCount; ++i) scores_[i] = others_[i - 1].score(frame);
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
