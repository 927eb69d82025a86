// SPDX-License-Identifier: Apache-2.0
// A rig as Python holds it: what it measures comes as dictionaries.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.hpp"
#include "python/stop.hpp"
#include "session/rig.hpp"
#include "session/run_keeper.hpp"

namespace fathom::python {

namespace py = pybind11;

/// Who is told of a run: Watcher's arguments.
struct Told {
  py::object tell;
  bool wants_frames = false;
};

/// One thread at a time measures with it; a second one is refused. Ctrl-C ends a run with
/// KeyboardInterrupt after the lens was put back.
class Instrument {
 public:
  using Open = std::function<std::unique_ptr<Rig>(const RigOptions&)>;

  /// Opens the rig without Python's lock. Throws what `open` does.
  Instrument(RigOptions options, const Open& open);
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;
  ~Instrument() { let_go(); }

  /// Where the lens is, in its unit; a move there.
  double position();
  double move_to(double position);
  /// A picture at a position, or where the lens stands; it stays there.
  py::object capture(std::optional<double> position);
  /// wishes: request_of(). stays: at the focus; else, and where there is none, the lens goes back.
  py::dict focus(const py::dict& wishes, bool stays, const Told& told);
  /// The scores of all positions; the lens goes back.
  py::dict sweep(std::optional<double> from, std::optional<double> to, std::optional<double> step,
                 const Told& told);
  /// The distance by `repeat` runs; the lens goes back.
  py::dict range(const Calibration& calibration, const py::dict& wishes, int repeat,
                 bool extrapolate, const Told& told);

  /// What it is: rig, metric, window, unit, travel.
  py::dict about();
  void place_target(double distance_mm);
  std::optional<double> target_mm();

  /// Ends the run that is under way, from a callback or another thread.
  void stop() { stop_->request(); }
  /// Gives the hardware back.
  void close();

 private:
  template <class Body>
  auto measure(Body body);
  Rig& open_rig();
  void let_go();
  RunKeeper keeper_of(const char* verb);

  std::shared_ptr<Stop> stop_ = std::make_shared<Stop>();
  std::unique_ptr<Rig> rig_;
  bool is_busy_ = false;  // asked with Python's lock held
};

}  // namespace fathom::python
