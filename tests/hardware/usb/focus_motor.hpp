// SPDX-License-Identifier: Apache-2.0
// The voice coil that moves the camera's lens: it starts late, takes its time and rings.
#pragma once

#include <cstdint>
#include <deque>

namespace fathom::usb {

struct FocusMotorOptions {
  double start = 0;           ///< Where it stands when plugged in.
  double speed_per_s = 4000;  ///< Focus units a second.
  double delay_ms = 0;        ///< From the command to the first movement.
  double ringing = 0;         ///< Amplitude at arrival in focus units; 0: none.
  double ringing_period_ms = 12;
  double ringing_decay_ms = 25;
};

class FocusMotor {
 public:
  explicit FocusMotor(const FocusMotorOptions& options);

  void command(double target, std::int64_t at_ns);
  /// Where the lens was at a time, now or up to some seconds ago.
  double position_at(std::int64_t time_ns) const;
  double target() const { return moves_.back().target; }

 private:
  struct Move {
    std::int64_t begin_ns;
    double from, target;
  };
  double along(const Move& move, std::int64_t time_ns) const;

  FocusMotorOptions options_;
  std::deque<Move> moves_;  ///< The last ones, never none.
};

}  // namespace fathom::usb
