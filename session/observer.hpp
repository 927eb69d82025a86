// SPDX-License-Identifier: Apache-2.0
// Who wants to know of a measurement while it runs: progress lines, the run's file, a page.
#pragma once

#include <initializer_list>
#include <span>
#include <vector>

#include "../engine/frame.hpp"
#include "../hal/lens.hpp"
#include "run.hpp"
#include "warning.hpp"

namespace fathom {

/// Told of everything that happens in a Session, in the order in which it does. An exception that
/// it throws ends the run. One that overrides nothing is nobody.
class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = default;
  Observer& operator=(const Observer&) = default;
  virtual ~Observer() = default;

  /// A run is about to evaluate its first position. run: all that is known by then, which is its
  /// limits and the scatter of repeated frames. positions: how many a sweep takes; 0 for a search,
  /// which decides as it goes.
  virtual void began([[maybe_unused]] const Run& run, [[maybe_unused]] std::size_t positions) {}

  /// A frame, or the mean of several, with the scores of its window. The frame is only lent. Those
  /// before began() are the repeated ones; each one after it is followed by its evaluated().
  virtual void frame([[maybe_unused]] const Frame& frame, [[maybe_unused]] const Arrival& arrival,
                     [[maybe_unused]] std::span<const double> scores) {}

  /// A position has been evaluated.
  virtual void evaluated([[maybe_unused]] const Measurement& measurement) {}

  /// A search has come to its end.
  virtual void found([[maybe_unused]] const Focus& focus) {}

  /// Something that does not end the run.
  virtual void warned([[maybe_unused]] const Warning& warning) {}
};

/// Several observers as one, told in this order.
class Observers final : public Observer {
 public:
  /// They must outlive this.
  Observers(std::initializer_list<Observer*> observers) : observers_(observers) {}

  void began(const Run& run, std::size_t positions) override;
  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) override;
  void evaluated(const Measurement& measurement) override;
  void found(const Focus& focus) override;
  void warned(const Warning& warning) override;

 private:
  std::vector<Observer*> observers_;
};

}  // namespace fathom
