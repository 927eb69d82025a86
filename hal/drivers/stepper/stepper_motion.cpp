// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/stepper/stepper_motion.hpp"

#include <pthread.h>
#include <signal.h>

#include <utility>

namespace fathom::stepper {
namespace {

/// While one lives, signals go to other threads; threads that are made meanwhile never get any. One
/// that came between the edges of a pulse would make it longer.
class SignalsElsewhere {
 public:
  SignalsElsewhere() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsElsewhere() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsElsewhere(const SignalsElsewhere&) = delete;
  SignalsElsewhere& operator=(const SignalsElsewhere&) = delete;

 private:
  sigset_t before_;
};

}  // namespace

StepperMotion::StepperMotion(Work work, std::shared_ptr<const StepLog> log, TimeSource& time,
                             StepperMotion*& slot)
    : log_(std::move(log)), time_(time), slot_(slot) {
  const SignalsElsewhere elsewhere;
  thread_ = std::thread([this, work = std::move(work)] { run(work); });
  slot_ = this;
}

StepperMotion::~StepperMotion() {
  wishes_.hurry = true;
  wishes_.stop = true;
  if (thread_.joinable()) thread_.join();
  slot_ = nullptr;
}

void StepperMotion::run(const Work& work) noexcept {
  try {
    arrival_ = work(wishes_);
  } catch (...) {
    problem_ = std::current_exception();
  }
  is_over_ = true;
}

std::optional<Arrival> StepperMotion::arrived() {
  if (!is_over_) return std::nullopt;
  return wait();
}

Arrival StepperMotion::wait() {
  if (thread_.joinable()) thread_.join();
  if (problem_) std::rethrow_exception(problem_);
  return arrival_;
}

Where StepperMotion::do_during(const Exposure& exposure) const {
  return log_->during(exposure, time_.now_ns());
}

}  // namespace fathom::stepper
