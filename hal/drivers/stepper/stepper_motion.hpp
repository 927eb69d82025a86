// SPDX-License-Identifier: Apache-2.0
// A move of a stepper motor in a thread of its own, which makes the steps while the caller watches.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <thread>

#include "hal/drivers/stepper/time_source.hpp"
#include "hal/motion.hpp"
#include "hal/step_log.hpp"

namespace fathom::stepper {

/// What the caller wants of a move that is under way; set by one thread, read by another.
struct Wishes {
  std::atomic<bool> stop = false;   ///< Come to rest where it is.
  std::atomic<bool> hurry = false;  ///< Do not wait for the lens to settle.
};

class StepperMotion final : public Motion {
 public:
  using Work = std::function<Arrival(const Wishes&)>;

  /// `work` moves and settles; it runs in the thread, and what it throws arrived() throws. `slot`
  /// points to this for as long as it lives. `time` and `slot` must outlive it. Throws
  /// std::system_error where there is no thread to be had; then `work` has not been called.
  StepperMotion(Work work, std::shared_ptr<const StepLog> log, TimeSource& time,
                StepperMotion*& slot);
  ~StepperMotion() override;

  void stop() override { wishes_.stop = true; }
  std::optional<Arrival> arrived() override;
  Arrival wait() override;

  /// Whether the thread has done its work, well or not.
  bool is_over() const { return is_over_; }

 private:
  Where do_during(const Exposure& exposure) const override;

  void run(const Work& work) noexcept;

  std::shared_ptr<const StepLog> log_;
  TimeSource& time_;
  StepperMotion*& slot_;
  Wishes wishes_;
  Arrival arrival_;             // the thread's until is_over_
  std::exception_ptr problem_;  // the same
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

}  // namespace fathom::stepper
