// SPDX-License-Identifier: Apache-2.0
// Gives each picture of a sweep to a map of depth.
#pragma once

#include <cstddef>

#include "mapping/depth_maker.hpp"
#include "session/observer.hpp"

namespace fathom::serve {

class StackTaker : public Observer {
 public:
  explicit StackTaker(mapping::DepthMaker& maker) : maker_(maker) {}

  void frame(const Frame& frame, const Arrival&, std::span<const double>) override {
    maker_.add(next_++, {.grey = frame.clone(), .colours = {}, .place = aligner_.add(frame)});
  }

 protected:
  const mapping::DepthMaker& maker() const { return maker_; }

 private:
  mapping::DepthMaker& maker_;
  StackAligner aligner_{Alignment::similarity};
  std::size_t next_ = 0;
};

}  // namespace fathom::serve
