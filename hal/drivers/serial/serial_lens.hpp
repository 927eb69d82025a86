// SPDX-License-Identifier: Apache-2.0
// A lens that a device on a serial port moves.
//
// Trust is that of a stepper motor (hal/whereabouts.hpp): a device that forgets where it is when it is
// switched off stands where a file says, or nobody knows. One that keeps count is asked.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hal/drivers/serial/device.hpp"
#include "hal/lens.hpp"
#include "hal/stop.hpp"
#include "hal/whereabouts.hpp"

namespace fathom::serial {

class SerialMotion;
class Voyage;

/// A move that nothing speaks against, not begun. Places are steps above the lowest position.
struct Trip {
  Standing from;
  int to = 0;
  std::vector<int> legs;  ///< Empty where it stands there already.
  StopWatch watch;
};

class SerialLens final : public Lens {
 public:
  /// Throws as Device and Whereabouts.
  SerialLens(const Settings& settings, StopRequests stop_requests);

  LensInfo info() const override { return info_; }
  double position() const override;
  Arrival move_to(double position) override;
  std::unique_ptr<Motion> start(double position) override;
  std::string why_unwatched() const override;
  Arrival home() override;
  void declare_at(double position) override;

 private:
  friend class Voyage;

  double place(int step) const { return info_.lowest + step * info_.resolution; }
  int step_at(double position) const;
  int takeup() const;
  void recall();
  Standing standing() const;
  Trip plan(double position) const;
  std::unique_ptr<SerialMotion> begin(Trip trip);
  void leave(const Trip& trip);
  void arrive(const Standing& standing);
  void require_its_own() const;
  [[noreturn]] void fail_unknown(const std::string& why) const;

  Settings settings_;
  StopRequests stop_requests_;
  std::unique_ptr<Device> device_;
  LensInfo info_;
  std::unique_ptr<Whereabouts> whereabouts_;  // of a device that forgets
  std::optional<int> approached_;  // of one that keeps count: where it came to from below
  std::int64_t rests_since_ns_ = 0;
  Voyage* voyage_ = nullptr;  // the one that lives
};

}  // namespace fathom::serial
