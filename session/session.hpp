// SPDX-License-Identifier: Apache-2.0
// Measuring on a rig: where to look, how often a frame is repeated, what is worth a warning. All of
// it is decided here and nowhere else.
#pragma once

#include <optional>
#include <vector>

#include "observer.hpp"
#include "rig.hpp"
#include "run.hpp"

namespace fathom {

/// The positions of a sweep, as a user says them; what is absent follows from the lens.
struct Sweep {
  std::optional<double> from;  ///< The lens's lowest.
  std::optional<double> to;    ///< The lens's highest.
  std::optional<double> step;  ///< Every stop of a lens that has only certain ones, else some
                               ///< hundred positions.
  /// The lens does not halt: frames are scored on its way up, no nearer to each other than `step`,
  /// all of them without one. What they leave out is visited afterwards.
  bool is_moving = false;
};

/// A rig that is measured with. Every run ends with the lens where its last evaluation left it
/// (LensReturn puts it back). Throws, from every run, as Rig::measure; what was measured until then
/// the observer knows.
class Session {
 public:
  /// The rig must outlive this.
  explicit Session(Rig& rig) : rig_(rig) {}

  /// Searches for the focus: scores kRepeatFrames frames where the search begins, to learn how far
  /// a score repeats, then searches and judges. `hill` begins where the lens stands, unless the
  /// request says where. Throws as resolve_limits.
  Run focus(const FocusRequest& request, Observer& observer);

  /// The focus again, from where `before` found it: within its limits, with its scatter, and with
  /// no repeated frames. before: a run of focus() or track() that ended.
  Run track(const Run& before, Observer& observer);

  /// Evaluates every position, upward. Throws as resolve_limits and sweep_positions; where the lens
  /// is to move on, Error(unsupported) for one that cannot be watched or a rig that is not live.
  Run sweep(const Sweep& sweep, Observer& observer);

  /// Evaluates these positions in this order.
  Run visit(const std::vector<double>& positions, Observer& observer);

 private:
  Run pass(const std::vector<double>& positions, double apart, Observer& observer);

  Rig& rig_;
};

}  // namespace fathom
