// SPDX-License-Identifier: Apache-2.0
#include "python/depth_values.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "python/arrays.hpp"
#include "python/colours.hpp"
#include "python/errors.hpp"

namespace fathom::python {
namespace {

using mapping::CurveGrid;
using mapping::DepthResult;
using mapping::DepthSummary;
using mapping::kAllDepthClasses;
using mapping::ReportFacts;
using Shape = std::vector<py::ssize_t>;

/// Numbers of a type that numpy knows, which the array owns from now on.
template <class Number, class Value>
py::array owning(std::vector<Value> values, const Shape& shape) {
  static_assert(sizeof(Number) == sizeof(Value));
  auto held = std::make_unique<std::vector<Value>>(std::move(values));
  const void* const data = held->data();
  const py::capsule owner(held.get(),
                          [](void* vector) { delete static_cast<std::vector<Value>*>(vector); });
  held.release();
  return py::array(py::dtype::of<Number>(), shape, data, owner);
}

py::array sharp_array(Sharp& sharp) {
  const Shape shape = {sharp.grey.height_px(), sharp.grey.width_px(), 3};
  if (!sharp.colours.bits8.empty())
    return owning<std::uint8_t>(std::move(sharp.colours.bits8), shape);
  if (!sharp.colours.bits16.empty())
    return owning<std::uint16_t>(std::move(sharp.colours.bits16), shape);
  return array_of(sharp.grey);
}

py::array curves_array(const CurveGrid& grid) {
  std::vector<float> all;
  for (const std::vector<float>& frame : grid.frames)
    all.insert(all.end(), frame.begin(), frame.end());
  const auto frames = static_cast<py::ssize_t>(grid.frames.size());
  return owning<float>(std::move(all), {frames, grid.rows, grid.columns});
}

py::dict dict_of(const DepthSummary& summary, std::size_t pixels) {
  py::dict parts;
  for (const DepthClass value : kAllDepthClasses)
    parts[to_string(value)] = summary.part(value, pixels);
  return py::dict(py::arg("low") = summary.low, py::arg("high") = summary.high,
                  py::arg("nearest") = summary.nearest, py::arg("farthest") = summary.farthest,
                  py::arg("median_sigma") = summary.median_sigma, py::arg("parts") = parts);
}

py::object dict_of(const std::optional<BlurModel>& blur) {
  if (!blur) return py::none();
  return py::dict(py::arg("px_per_unit") = blur->px_per_unit, py::arg("rest_px") = blur->rest_px,
                  py::arg("shape") = to_string(blur->shape));
}

std::optional<BlurModel> blur_of(const py::object& value) {
  if (value.is_none()) return std::nullopt;
  BlurModel blur;
  blur.px_per_unit = value["px_per_unit"].cast<double>();
  blur.rest_px = value["rest_px"].cast<double>();
  blur.shape = parse_blur_shape(value["shape"].cast<std::string>());
  return blur;
}

py::object dict_of(const std::optional<ReportFacts::Growth>& growth) {
  if (!growth) return py::none();
  return py::dict(py::arg("told") = growth->told, py::arg("fitted") = growth->fitted);
}

std::optional<ReportFacts::Growth> growth_of(const py::object& value) {
  if (value.is_none()) return std::nullopt;
  return ReportFacts::Growth{.told = value["told"].cast<double>(),
                             .fitted = value["fitted"].cast<double>()};
}

py::dict dict_of(const ReportFacts& facts) {
  return py::dict(py::arg("calibration") = facts.calibration, py::arg("window") = facts.window,
                  py::arg("stride") = facts.stride, py::arg("align") = facts.align,
                  py::arg("growth") = dict_of(facts.growth), py::arg("moved_px") = facts.moved_px,
                  py::arg("is_filled") = facts.is_filled,
                  py::arg("frames_expected") = facts.frames_expected,
                  py::arg("backend") = facts.backend, py::arg("read_seconds") = facts.read_seconds,
                  py::arg("map_seconds") = facts.map_seconds);
}

template <class Number>
using Plain = py::array_t<Number, py::array::c_style | py::array::forcecast>;

/// The numbers of an array of this shape.
template <class Number, class Value = Number>
std::vector<Value> vector_of(const py::dict& values, const char* name, const Shape& shape) {
  const auto array = Plain<Number>::ensure(values[name]);
  if (!array) throw py::error_already_set();
  if (!std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim())) {
    refuse(fmt::format("{} has shape {}; a map of {} x {} px has another", name,
                       py::str(array.attr("shape")).template cast<std::string>(), shape[1],
                       shape[0]));
  }
  const auto* const first = reinterpret_cast<const Value*>(array.data());
  return {first, first + array.size()};
}

Sharp sharp_of(const py::dict& values, const Shape& shape) {
  const auto array = values["sharp"].cast<py::array>();
  Sharp sharp;
  if (array.ndim() == 2) {
    sharp.grey = Pictures(array, "sharp").frame(0).clone();
  } else {
    mapping::ColourPicture picture = colour_picture(array, "sharp");
    sharp.grey = std::move(picture.grey);
    sharp.colours = std::move(picture.colours);
  }
  if (sharp.grey.height_px() != shape[0] || sharp.grey.width_px() != shape[1])
    refuse("sharp has another size than depth");
  sharp.frame = vector_of<std::uint16_t>(values, "index", shape);
  return sharp;
}

CurveGrid curves_of(const py::dict& values) {
  const auto array = Plain<float>::ensure(values["curves"]);
  if (!array || array.ndim() != 3) refuse("curves needs 3 axes: pictures, rows, columns");
  CurveGrid grid;
  grid.rows = static_cast<int>(array.shape(1));
  grid.columns = static_cast<int>(array.shape(2));
  const auto cells = static_cast<std::ptrdiff_t>(grid.rows) * grid.columns;
  for (py::ssize_t i = 0; i < array.shape(0); ++i)
    grid.frames.emplace_back(array.data() + i * cells, array.data() + (i + 1) * cells);
  return grid;
}

/// A row of each frame: scale, angle_rad, dx_px, dy_px, gain.
constexpr py::ssize_t kSeenColumns = 5;

py::array seen_array(const std::vector<Seen>& seen) {
  py::array_t<double> rows({static_cast<py::ssize_t>(seen.size()), kSeenColumns});
  double* value = rows.mutable_data();
  for (const auto& [place, gain] : seen) {
    for (const double one : {place.scale, place.angle_rad, place.dx_px, place.dy_px, gain})
      *value++ = one;
  }
  return rows;
}

std::vector<Seen> seen_of(const py::dict& values, std::size_t frames) {
  const auto rows = Plain<double>::ensure(values["seen"]);
  if (!rows || rows.ndim() != 2 || rows.shape(1) != kSeenColumns ||
      rows.shape(0) != static_cast<py::ssize_t>(frames))
    refuse("seen needs a row of 5 for each position");
  std::vector<Seen> seen(frames);
  const double* value = rows.data();
  for (Seen& one : seen) {
    one = {.place = {value[0], value[1], value[2], value[3]}, .gain = value[4]};
    value += kSeenColumns;
  }
  return seen;
}

void require_classes(const std::vector<DepthClass>& classes) {
  for (const DepthClass value : classes) {
    if (static_cast<std::size_t>(value) >= mapping::kDepthClasses)
      refuse(fmt::format("classes holds {}, which is no class", static_cast<int>(value)));
  }
}

DepthMaps maps_of(const py::dict& values, const Shape& shape) {
  DepthMaps maps;
  maps.height_px = static_cast<int>(shape[0]);
  maps.width_px = static_cast<int>(shape[1]);
  maps.position = vector_of<float>(values, "depth", shape);
  maps.sigma = vector_of<float>(values, "sigma", shape);
  maps.confidence = vector_of<float>(values, "confidence", shape);
  maps.classes = vector_of<std::uint8_t, DepthClass>(values, "classes", shape);
  require_classes(maps.classes);
  return maps;
}

}  // namespace

py::dict dict_of(DepthResult result, const ReportFacts& facts) {
  const DepthSummary summary = mapping::summary_of(result.maps);
  const std::size_t pixels = result.pixels();
  const Shape shape = {result.maps.height_px, result.maps.width_px};
  py::dict values(py::arg("unit") = result.unit, py::arg("lens_unit") = result.lens_unit,
                  py::arg("rig") = result.rig, py::arg("positions") = result.positions,
                  py::arg("spacing_um") = result.spacing_um, py::arg("blur") = dict_of(result.blur),
                  py::arg("summary") = dict_of(summary, pixels), py::arg("facts") = dict_of(facts));
  values["curves"] = curves_array(result.curves);
  values["seen"] = seen_array(result.seen);
  values["index"] = owning<std::uint16_t>(std::move(result.sharp.frame), shape);
  values["sharp"] = sharp_array(result.sharp);
  values["depth"] = owning<float>(std::move(result.maps.position), shape);
  values["sigma"] = owning<float>(std::move(result.maps.sigma), shape);
  values["confidence"] = owning<float>(std::move(result.maps.confidence), shape);
  values["classes"] = owning<std::uint8_t>(std::move(result.maps.classes), shape);
  return values;
}

DepthResult depth_result_of(const py::dict& values) {
  const auto depth = Plain<float>::ensure(values["depth"]);
  if (!depth || depth.ndim() != 2) refuse("depth needs 2 axes: rows and columns");
  const Shape shape = {depth.shape(0), depth.shape(1)};
  DepthResult result;
  result.maps = maps_of(values, shape);
  result.sharp = sharp_of(values, shape);
  result.curves = curves_of(values);
  result.positions = values["positions"].cast<std::vector<double>>();
  result.seen = seen_of(values, result.positions.size());
  result.lens_unit = values["lens_unit"].cast<std::string>();
  result.unit = values["unit"].cast<std::string>();
  result.blur = blur_of(values["blur"]);
  result.rig = values["rig"].cast<std::string>();
  result.spacing_um = values["spacing_um"].cast<std::optional<double>>();
  return result;
}

ReportFacts facts_of(const py::dict& values) {
  const auto given = values["facts"].cast<py::dict>();
  ReportFacts facts;
  facts.calibration = given["calibration"].cast<std::string>();
  facts.window = given["window"].cast<std::string>();
  facts.stride = given["stride"].cast<std::optional<int>>();
  facts.align = given["align"].cast<std::string>();
  facts.growth = growth_of(given["growth"]);
  facts.moved_px = given["moved_px"].cast<double>();
  facts.is_filled = given["is_filled"].cast<bool>();
  facts.frames_expected = given["frames_expected"].cast<std::size_t>();
  facts.backend = given["backend"].cast<std::string>();
  facts.read_seconds = given["read_seconds"].cast<double>();
  facts.map_seconds = given["map_seconds"].cast<double>();
  return facts;
}

}  // namespace fathom::python
