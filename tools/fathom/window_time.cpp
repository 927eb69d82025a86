// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/window_time.hpp"

#include <chrono>
#include <ctime>
#include <vector>

#include "engine/error.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

using Seconds = std::chrono::duration<double>;

Seconds processor_time_of_thread() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return Seconds(static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec));
}

/// Calls that go round the windows, so that no call finds its pixels where the last one left them.
class Calls {
 public:
  Calls(Plan& plan, const Frame& frame, std::span<const Window> windows, std::size_t batch)
      : plan_(plan),
        frame_(frame),
        windows_(windows),
        batch_(batch),
        values_(batch * plan.spec().outputs()) {}

  Seconds time(std::size_t calls) {
    if (stop_requested()) throw Error(ErrorCode::cancelled, "stopped on request");
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < calls; ++i) {
      plan_.score(frame_, windows_.subspan(next_, batch_), values_);
      next_ = (next_ + batch_) % windows_.size();
    }
    return std::chrono::steady_clock::now() - start;
  }

 private:
  Plan& plan_;
  const Frame& frame_;
  std::span<const Window> windows_;
  std::size_t batch_;
  std::vector<double> values_;
  std::size_t next_ = 0;
};

/// Wakes threads and caches; returns how many calls are long enough for the clock.
std::size_t warm_up(Calls& calls) {
  constexpr Seconds kEnough(0.02), kMeasurable(0.002);
  std::size_t count = 1;
  for (Seconds all(0); all < kEnough;) {
    const Seconds time = calls.time(count);
    all += time;
    if (time < kMeasurable) count *= 2;
  }
  return count;
}

}  // namespace

WindowTime time_windows(Plan& plan, const Frame& frame, std::span<const Window> windows,
                        std::size_t batch) {
  constexpr Seconds kLongEnough(0.15), kTooLong(0.5);
  constexpr std::size_t kRepeats = 5;
  Calls calls(plan, frame, windows, batch);
  const std::size_t count = warm_up(calls);
  std::vector<Sample> samples;
  Seconds all(0);
  while (all < kLongEnough || (samples.size() < kRepeats && all < kTooLong)) {
    const Seconds computed_before = processor_time_of_thread();
    const Seconds time = calls.time(count);
    const Seconds computed = processor_time_of_thread() - computed_before;
    all += time;
    samples.push_back(
        {1e6 * time.count() / static_cast<double>(count * batch), time.count(), computed.count()});
  }
  return summary_of(samples);
}

}  // namespace fathom::cli
