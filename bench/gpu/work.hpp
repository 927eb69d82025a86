// SPDX-License-Identifier: Apache-2.0
// What is timed: batch after batch, two of them in flight.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "bench/gpu/pixels.hpp"
#include "engine/backend.hpp"

namespace fathom::bench {

/// One configuration.
struct Cell {
  MetricSpec spec;
  Depth depth = Depth::bits8;
  std::size_t batch = 0;  ///< Windows that were asked for.
  Tiles tiles;            ///< Those that there are: fewer where a frame would be too large.
};

/// Batches that take turns in two seats, so that one is prepared while another is computed.
class Work {
 public:
  virtual ~Work() = default;
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  /// Waits for the older batch, and starts another in its place.
  void step() {
    finish(next_);
    do_start(next_);
    is_aloft_[next_] = true;
    next_ = 1 - next_;
  }

  /// Waits for both.
  void land() {
    for (const int seat : {next_, 1 - next_}) finish(seat);
  }

  /// What a seat scored last: the frame, and the values of every window; none where nothing scores.
  virtual const Frame& frame(int seat) const = 0;
  virtual std::vector<double> scores(int seat) const = 0;

 protected:
  Work() = default;

 private:
  virtual void do_start(int seat) = 0;
  virtual void do_finish(int seat) = 0;

  void finish(int seat) {
    if (!is_aloft_[seat]) return;
    is_aloft_[seat] = false;
    do_finish(seat);
  }

  std::array<bool, 2> is_aloft_ = {};
  int next_ = 0;
};

/// As users do it: a fresh frame for every batch, through the public Plan.
std::unique_ptr<Work> streamed(std::unique_ptr<Plan> plan, const Pixels& pixels, const Cell& cell);

}  // namespace fathom::bench
