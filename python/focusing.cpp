// SPDX-License-Identifier: Apache-2.0
#include "python/focusing.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "focus/lobes.hpp"
#include "focus/noise.hpp"
#include "focus/searches.hpp"
#include "python/errors.hpp"
#include "python/focus_values.hpp"
#include "python/given.hpp"

namespace fathom::python {
namespace {

FocusCurve curve_of(const std::vector<double>& positions, const std::vector<double>& scores) {
  if (positions.size() != scores.size()) {
    refuse(
        fmt::format("positions holds {} numbers, and scores {}", positions.size(), scores.size()));
  }
  if (positions.empty()) refuse("positions is empty");
  std::vector<Evaluation> evaluations;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!std::isfinite(positions[i])) refuse(fmt::format("positions[{}] is not finite", i));
    if (!std::isfinite(scores[i])) refuse(fmt::format("scores[{}] is not finite", i));
    evaluations.push_back({static_cast<int>(i) + 1, positions[i], scores[i]});
  }
  return FocusCurve(std::move(evaluations));
}

void require_distinct(const FocusCurve& curve) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (curve[i].position == curve[i - 1].position)
      refuse(
          fmt::format("positions holds {} twice; give the mean of its scores", curve[i].position));
  }
}

/// The peak of the highest hill of a curve. scatter: of repeated scores, relative to them; 0 where
/// nobody knows, so that the points' own scatter about the shape tells.
py::dict fit(const std::vector<double>& positions, const std::vector<double>& scores,
             double scatter) {
  if (!(scatter >= 0)) refuse(fmt::format("scatter is {}; it is 0 or more", scatter));
  const FocusCurve curve = curve_of(positions, scores);
  require_distinct(curve);
  constexpr double kLeastDip = 0.01;  // of the height: what rounding and a lamp leave
  const double dip =
      std::max(3 * scatter * std::abs(curve.top().score), kLeastDip * curve.height());
  const Lobe top = find_lobes(curve, dip).front();
  const auto lobe = std::span(curve.evaluations()).subspan(top.first, top.last - top.first + 1);
  return dict_of(
      fit_peak(lobe, top.best - top.first, curve.floor(), noise_of(scatter, curve.floor())));
}

py::object wish(const py::dict& wishes, const char* name) {
  return wishes.contains(name) ? py::object(wishes[name]) : py::none();
}

std::optional<double> number_of(const py::dict& wishes, const char* name) {
  return wished_number(wish(wishes, name), name);
}

std::optional<bool> flag_of(const py::dict& wishes, const char* name) {
  const py::object value = wish(wishes, name);
  if (value.is_none()) return std::nullopt;
  if (!py::isinstance<py::bool_>(value)) refuse(fmt::format("{} is True, False or None", name));
  return value.cast<bool>();
}

std::optional<double> above_0(const py::dict& wishes, const char* name) {
  const std::optional<double> number = number_of(wishes, name);
  if (number && !(*number > 0 && std::isfinite(*number)))
    refuse(fmt::format("{} is {}; it is above 0", name, *number));
  return number;
}

std::optional<SearchMethod> search_wish(const py::object& value) {
  if (value.is_none()) return std::nullopt;
  std::vector<std::string> names;
  for (const Search& search : searches()) names.emplace_back(search.name);
  return searches()[given_choice(value, "search", names)].method;
}

std::optional<PeakMethod> peak_wish(const py::object& value) {
  if (value.is_none()) return std::nullopt;
  constexpr PeakMethod kAll[] = {PeakMethod::fit, PeakMethod::evaluated};
  return kAll[given_choice(value, "peak", {to_string(kAll[0]), to_string(kAll[1])})];
}

void require_known(const py::dict& wishes) {
  constexpr const char* kKnown[] = {"from_",  "to",    "search", "peak",  "tolerance",
                                    "frames", "start", "blur",   "moving"};
  for (const auto& [name, value] : wishes) {
    const auto text = py::str(name).cast<std::string>();
    if (std::ranges::none_of(kKnown, [&](const char* known) { return text == known; }))
      throw py::type_error("unexpected argument '" + text +
                           "'; a search takes from_, to, search, "
                           "peak, tolerance, frames, start, blur and moving");
  }
}

}  // namespace

void require_part(const LensInfo& lens, const std::optional<double>& from,
                  const std::optional<double>& to) {
  if (from) require_on_travel(lens, *from, "from_");
  if (to) require_on_travel(lens, *to, "to");
  if (from && to && *from > *to)
    refuse(fmt::format("from_ is {} and to is {}; from_ is the lower one", *from, *to));
}

void require_on_travel(const LensInfo& lens, double position, const char* name) {
  if (position >= lens.lowest && position <= lens.highest) return;
  throw Error(ErrorCode::out_of_bounds,
              fmt::format("{} is {}; positions are from {} to {} {}", name, position, lens.lowest,
                          lens.highest, lens.unit));
}

FocusRequest request_of(const py::dict& wishes) {
  require_known(wishes);
  const std::optional<double> from = number_of(wishes, "from_"), to = number_of(wishes, "to");
  FocusRequest request = FocusRequest::within(from, to);
  if (const auto search = search_wish(wish(wishes, "search"))) request.search = *search;
  if (const auto peak = peak_wish(wish(wishes, "peak"))) request.peak = *peak;
  request.tolerance = above_0(wishes, "tolerance");
  request.frames = wished_count(wish(wishes, "frames"), "frames");
  request.start = number_of(wishes, "start");
  request.moving = flag_of(wishes, "moving");
  if (const auto blur = above_0(wishes, "blur")) request.blur = BlurModel{.px_per_unit = *blur};
  if (request.blur) require_blur(request);
  return request;
}

void bind_focusing(py::module_& module) { module.def("fit", &fit); }

}  // namespace fathom::python
