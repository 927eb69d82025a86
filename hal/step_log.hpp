// SPDX-License-Identifier: Apache-2.0
// When a motor made its steps, and so where the glass stood at any time.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "glass.hpp"
#include "motion.hpp"

namespace fathom {

/// The steps of one move, each with its time. One thread may log while another asks.
class StepLog {
 public:
  /// A motor that has stood at `position` since `since_ns`. is_approached: it came from below, far
  /// enough to take up the play.
  StepLog(int position, bool is_approached, const Play& play, std::int64_t since_ns);

  /// Logs a step, 1 upward or -1 downward. `make` makes it and returns when. Whoever asks meanwhile
  /// waits, so that no step that is past is missing from an answer. What `make` throws is passed
  /// on, and then nobody knows where the glass is.
  template <class Make>
  void make_step(int direction, const Make& make) {
    const std::lock_guard lock(mutex_);
    is_lost_ = true;
    add(direction, make());
    is_lost_ = false;
  }

  /// The move has ended as it should, its play taken up: the glass is where the motor stands.
  void arrive(std::int64_t time_ns);

  /// Whether the glass is surely where the motor stands.
  bool is_taken_up() const;

  /// Mean place, sigma and smear over an exposure; see Motion::during for what it throws. now_ns:
  /// the end of what is known.
  Where during(const Exposure& exposure, std::int64_t now_ns) const;

 private:
  /// Where the glass was from a time on.
  struct Place {
    std::int64_t since_ns;
    Glass glass;
  };

  void add(int direction, std::int64_t time_ns);
  KnownTime known_time(std::int64_t now_ns) const;
  /// Whether the motor turned at any moment of an exposure.
  bool turns_during(const Exposure& exposure) const;

  mutable std::mutex mutex_;
  Play play_;
  int position_;
  std::vector<Place> places_;  // never empty
  std::int64_t first_step_ns_ = INT64_MAX, last_step_ns_ = INT64_MIN;
  bool is_lost_ = false;  // after the last place nobody knows
};

}  // namespace fathom
