// SPDX-License-Identifier: Apache-2.0
// A device that can be lost, behind the contract.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "backends/gpu/arithmetic.hpp"
#include "backends/gpu/shape.hpp"
#include "backends/gpu/wait_limit.hpp"
#include "engine/backend.hpp"
#include "engine/error.hpp"
#include "engine/process.hpp"

namespace fathom::gpu {

/// What opens it and who it is.
template <class Context>
struct Opening {
  std::function<std::shared_ptr<Context>()> context;  ///< Throws Error(unavailable).
  Limits limits;
  std::string name;  ///< Of files about the device: backend, device, driver.
  std::string key;   ///< Of what these files say: the kernels.
};

/// Context: is_lost(), and make_plan(context, spec, capacity) beside it.
template <class Context>
class FlightDevice final : public Device {
 public:
  FlightDevice(DeviceInfo info, Opening<Context> opening)
      : Device(std::move(info)), opening_(std::move(opening)), context_(opening_.context()) {}

  ~FlightDevice() override {
    if (forks() != opened_in_) keep_for_ever(context_);  // the parent's
  }

  bool fuses(const MetricSpec& spec) const override {
    switch (spec.measure) {
      case Measure::moment:
      case Measure::entropy:
        return true;
      case Measure::rings:
        return too_small_for(spec, opening_.limits).empty();  // else a spectrum may fit
    }
    return false;
  }

 private:
  std::string do_unsupported(const MetricSpec& spec) const override {
    std::string reason = no_kernel_for(spec.transform);
    if (reason.empty()) reason = too_small_for(spec, opening_.limits);
    // Sums of small integers are exact in any arithmetic.
    return !reason.empty() || spec.is_exact() ? reason : fault();
  }

  /// A lost device stays lost for its plans; the next plan gets a fresh one.
  std::shared_ptr<Context> live_context() const {
    if (forks() != opened_in_) {
      throw Error(ErrorCode::device_lost,
                  "this process was forked after the device was opened, which serves its parent "
                  "only; fork first, then open a device in each process");
    }
    const std::lock_guard lock(context_mutex_);
    if (context_->is_lost()) context_ = opening_.context();
    return context_;
  }

  /// Why this device's floats are not to be trusted, measured once.
  const std::string& fault() const {
    const std::lock_guard lock(fault_mutex_);
    if (!fault_) {
      fault_ = arithmetic_fault(
          opening_.name + ".arithmetic", opening_.key,
          [this](const MetricSpec& spec) { return make_plan(live_context(), spec, 1); });
    }
    return *fault_;
  }

  std::unique_ptr<Plan> do_plan(const MetricSpec& spec, std::size_t capacity) override {
    return make_plan(live_context(), spec, capacity);
  }

  const unsigned opened_in_ = forks();
  Opening<Context> opening_;
  mutable std::mutex context_mutex_;
  mutable std::shared_ptr<Context> context_;
  mutable std::mutex fault_mutex_;
  mutable std::optional<std::string> fault_;
};

}  // namespace fathom::gpu
