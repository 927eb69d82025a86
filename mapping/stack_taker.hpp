// SPDX-License-Identifier: Apache-2.0
// Gives each picture of a live sweep to a map of depth as it comes.
#pragma once

#include <cstddef>

#include "mapping/depth_maker.hpp"
#include "session/observer.hpp"

namespace fathom::mapping {

class StackTaker : public Observer {
 public:
  /// Both must outlive this.
  StackTaker(DepthMaker& maker, StackAligner& aligner) : maker_(maker), aligner_(aligner) {}

  void frame(const Frame& frame, const Arrival&, std::span<const double>) override {
    maker_.add(next_++, {.grey = frame.clone(), .colours = {}, .place = aligner_.add(frame)});
  }

 protected:
  const DepthMaker& maker() const { return maker_; }
  std::size_t taken() const { return next_; }

 private:
  DepthMaker& maker_;
  StackAligner& aligner_;
  std::size_t next_ = 0;
};

}  // namespace fathom::mapping
