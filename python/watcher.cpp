// SPDX-License-Identifier: Apache-2.0
#include "python/watcher.hpp"

#include "python/arrays.hpp"
#include "python/focus_values.hpp"
#include "python/warning_values.hpp"

namespace fathom::python {

void Watcher::began(const Run& run, std::size_t positions) {
  if (!is_there_) return;
  const py::gil_scoped_acquire lock;
  tell_("began", py::dict(py::arg("scatter") = run.repeat_scatter, py::arg("repeats") = run.repeats,
                          py::arg("positions") = positions));
}

void Watcher::frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) {
  if (!wants_frames_) return;
  const py::gil_scoped_acquire lock;
  tell_("frame", py::dict(py::arg("image") = array_of(frame),
                          py::arg("position") = arrival.position, py::arg("score") = scores[0]));
}

void Watcher::evaluated(const Measurement& measurement) {
  if (!is_there_) return;
  const py::gil_scoped_acquire lock;
  tell_("evaluated", py::dict(py::arg("position") = measurement.position,
                              py::arg("score") = measurement.sample().score));
}

void Watcher::found(const Focus& focus) {
  if (!is_there_) return;
  const py::gil_scoped_acquire lock;
  tell_("found", dict_of(focus));
}

void Watcher::warned(const Warning& warning) {
  if (!is_there_) return;
  const py::gil_scoped_acquire lock;
  tell_("warned", dict_of(warning));
}

}  // namespace fathom::python
