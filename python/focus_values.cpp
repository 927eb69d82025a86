// SPDX-License-Identifier: Apache-2.0
#include "python/focus_values.hpp"

#include <pybind11/numpy.h>

#include "python/terms.hpp"
#include "words/verdict_words.hpp"

namespace fathom::python {
namespace {

/// All numbers of the reason, and its words.
py::dict dict_of(const Verdict& verdict) {
  const Reason& reason = verdict.reason;
  return py::dict(
      py::arg("why") = to_string(reason.why), py::arg("text") = words_for(verdict, kTerms),
      py::arg("position") = reason.position, py::arg("r_squared") = reason.r_squared,
      py::arg("confidence") = reason.confidence,
      py::arg("second_position") = reason.second_position,
      py::arg("second_part") = reason.second_part, py::arg("contrast") = reason.contrast,
      py::arg("is_live") = reason.is_live, py::arg("at_lens_end") = reason.at_lens_end,
      py::arg("whole_travel") = reason.whole_travel,
      py::arg("largest_window") = reason.largest_window, py::arg("saturated") = reason.saturated,
      py::arg("light_left") = reason.light_left, py::arg("evaluations") = reason.evaluations,
      py::arg("dead") = reason.dead);
}

}  // namespace

py::dict dict_of(const Peak& peak) {
  return py::dict(py::arg("position") = peak.position, py::arg("sigma") = peak.sigma,
                  py::arg("score") = peak.score, py::arg("half_width") = peak.half_width,
                  py::arg("r_squared") = peak.r_squared, py::arg("shape") = to_string(peak.shape),
                  py::arg("points") = peak.points);
}

py::dict curve_of(const std::vector<Evaluation>& evaluations) {
  const FocusCurve curve(evaluations);
  const auto count = static_cast<py::ssize_t>(curve.size());
  py::array_t<double> positions(count), scores(count);
  for (py::ssize_t i = 0; i < count; ++i) {
    positions.mutable_at(i) = curve[static_cast<std::size_t>(i)].position;
    scores.mutable_at(i) = curve[static_cast<std::size_t>(i)].score;
  }
  return py::dict(py::arg("positions") = positions, py::arg("scores") = scores);
}

py::dict dict_of(const Focus& focus) {
  py::list lobes;
  for (const Peak& lobe : focus.lobes) lobes.append(dict_of(lobe));
  return py::dict(py::arg("verdict") = to_string(focus.result()),
                  py::arg("confidence") = focus.verdict.confidence,
                  py::arg("rise") = focus.verdict.rise.rise,
                  py::arg("needed_rise") = focus.verdict.rise.needed,
                  py::arg("reason") = dict_of(focus.verdict), py::arg("peak") = dict_of(focus.peak),
                  py::arg("lobes") = lobes, py::arg("floor") = focus.floor,
                  py::arg("curve") = curve_of(focus.evaluations));
}

py::dict dict_of(const Journey& journey) {
  return py::dict(py::arg("travel") = journey.travel, py::arg("rig_seconds") = journey.rig_seconds,
                  py::arg("frames") = journey.frames, py::arg("on_the_way") = journey.on_the_way);
}

}  // namespace fathom::python
