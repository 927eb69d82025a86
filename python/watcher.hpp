// SPDX-License-Identifier: Apache-2.0
// A function of Python that is told of a measurement while it runs.
#pragma once

#include <pybind11/pybind11.h>

#include "session/observer.hpp"

namespace fathom::python {

/// Calls tell(name, values) with Python's lock. What it throws ends the run.
class Watcher final : public Observer {
 public:
  /// tell: or None, for nobody. wants_frames: a copy of every frame is told, too.
  Watcher(pybind11::object tell, bool wants_frames)
      : tell_(std::move(tell)), is_there_(!tell_.is_none()), wants_frames_(wants_frames) {}

  void began(const Run& run, std::size_t positions) override;
  void frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) override;
  void evaluated(const Measurement& measurement) override;
  void found(const Focus& focus) override;
  void warned(const Warning& warning) override;

 private:
  pybind11::object tell_;
  bool is_there_, wants_frames_;
};

}  // namespace fathom::python
