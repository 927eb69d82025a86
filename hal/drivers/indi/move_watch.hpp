// SPDX-License-Identifier: Apache-2.0
// What a focuser's driver says of one move, and what that comes to: numbers in, a word out.
//
// A driver may say anything, and as often as it likes. Only what brings the motor nearer to its
// goal than it has ever been counts as progress, and only by a thousandth of the way: so a move
// ends, whatever is said.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/drivers/indi/devices.hpp"

namespace fathom::indi {

/// What was asked for, and when an answer is believed.
struct MoveOrder {
  std::optional<double> goal;  ///< Where it shall end; absent where the driver does not count.
  double from = 0;             ///< Where it stands.
  double steps = 0;            ///< How far it has to go, where there is no goal.
  double accuracy = 0;         ///< So far beside the goal it may come to rest.
  std::uint64_t before = 0;    ///< The property's serial when it was asked for.
  std::int64_t rest_ns = 0;    ///< What is said for so long without a change is believed.
  std::int64_t now_ns = 0;     ///< When it was asked for.
};

enum class MoveWord {
  nothing,   ///< Nothing new.
  progress,  ///< It has begun, or has come nearer.
  arrived,   ///< At its goal, or at rest beside it.
  failed,    ///< The driver says so.
  nonsense,  ///< The driver says that it stands nowhere.
};

class MoveWatch {
 public:
  explicit MoveWatch(const MoveOrder& order);

  /// Takes in what the property says now. said: the place that it tells or, where it does not
  /// count, a number that may be the rest of the way. To be asked again while time goes by.
  MoveWord heed(const Property& property, double said, std::int64_t now_ns);

  /// Whether the driver has answered and does not call itself busy: it thinks that it is done.
  bool thinks_done() const { return has_answered_ && !is_busy_; }
  /// Whether what it said last is near enough to the goal.
  bool is_beside() const { return order_.goal && beside() <= order_.accuracy; }
  /// What it said last; NaN before that.
  double said() const { return said_; }

 private:
  double beside() const;
  bool has_come_nearer();
  bool is_there(const Property& property, std::int64_t now_ns) const;

  MoveOrder order_;
  double least_;    // way left, the least so far
  double quantum_;  // what counts as nearer
  double said_;
  std::int64_t since_ns_;  // when that, or the state, changed last
  bool has_answered_ = false;
  bool is_busy_ = false;
  bool has_begun_ = false;
};

}  // namespace fathom::indi
