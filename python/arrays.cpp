// SPDX-License-Identifier: Apache-2.0
#include "python/arrays.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "engine/error.hpp"
#include "python/errors.hpp"

namespace fathom::python {
namespace {

const py::detail::PyArrayDescr_Proxy& descriptor(const py::array& array) {
  const py::handle held = py::detail::array_proxy(array.ptr())->descr;
  return *py::detail::array_descriptor_proxy(held.ptr());
}

/// A text that is none in UTF-8 is shown with its escapes.
std::string text_of(py::handle value) {
  const py::str shown(value);
  Py_ssize_t bytes = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(shown.ptr(), &bytes);
  if (text != nullptr) return {text, static_cast<std::size_t>(bytes)};
  PyErr_Clear();
  return py::reinterpret_steal<py::str>(PyObject_ASCII(shown.ptr())).cast<std::string>();
}

bool is_native(const py::array& array) {
  const char order = descriptor(array).byteorder;
  return order == '|' || order == '=';
}

py::array as_array(py::handle image, const char* argument) {
  if (py::isinstance<py::array>(image)) return py::reinterpret_borrow<py::array>(image);
  if (image.is_none()) refuse(fmt::format("{} is None; give a numpy array of pixels", argument));
  return py::module_::import("numpy").attr("asarray")(image).cast<py::array>();
}

/// Views the numbers 0 and 1 of a mask are as good pixels as any.
py::array as_pixels(const py::array& array) {
  return descriptor(array).kind == 'b' ? array.attr("view")("uint8").cast<py::array>() : array;
}

void warn_of_copy(const char* argument, const char* why) {
  const py::object kind = py::module_::import("fathom._errors").attr("CopyWarning");
  const std::string text = fmt::format("{} {} and is copied first", argument, why);
  if (PyErr_WarnEx(kind.ptr(), text.c_str(), 2) != 0) throw py::error_already_set();
}

int side(py::ssize_t length, const char* argument) {
  if (length <= std::numeric_limits<int>::max()) return static_cast<int>(length);
  refuse(fmt::format("{} has a side of {} px", argument, length));
}

/// One of several windows, as messages call it.
std::string named(const char* name, std::size_t i) { return fmt::format("{}[{}]", name, i); }

int coordinate(py::handle value, const char* name, std::size_t i, const char* axis) {
  const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!number) {
    PyErr_Clear();
    refuse(fmt::format("{}: {} is {}, and no integer", named(name, i), axis, text_of(value)));
  }
  int is_over = 0;
  const long place = PyLong_AsLongAndOverflow(number.ptr(), &is_over);
  if (is_over != 0 || place < std::numeric_limits<int>::min() / 2 ||
      place > std::numeric_limits<int>::max() / 2) {
    refuse(fmt::format("{}: {} = {} is outside of every picture", named(name, i), axis,
                       text_of(value)));
  }
  return static_cast<int>(place);
}

/// A tuple or list of its items; nothing for what has none.
py::object items_of(py::handle value) {
  PyObject* const items = PySequence_Fast(value.ptr(), "");
  if (items == nullptr) PyErr_Clear();
  return py::reinterpret_steal<py::object>(items);
}

Window window_of(py::handle pair, const char* name, std::size_t i, int n) {
  const py::object items = items_of(pair);
  if (!items || PySequence_Fast_GET_SIZE(items.ptr()) != 2) {
    refuse(
        fmt::format("{} is {}; each window is its corner (x, y)", named(name, i), text_of(pair)));
  }
  return {coordinate(PySequence_Fast_GET_ITEM(items.ptr(), 0), name, i, "x"),
          coordinate(PySequence_Fast_GET_ITEM(items.ptr(), 1), name, i, "y"), n};
}

/// Of an integer array of shape (K, 2): without an object of Python's for each number.
void read_array(const py::array& array, const char* name, int n, std::vector<Window>& list) {
  const char kind = descriptor(array).kind;
  if (array.ndim() != 2 || array.shape(1) != 2 || (kind != 'i' && kind != 'u')) {
    refuse(
        fmt::format("{} is an array of {} and shape {}; it needs integers and shape (K, 2): the "
                    "corners x, y",
                    name, text_of(array.dtype()), text_of(array.attr("shape"))));
  }
  const auto corners = py::array_t<std::int64_t, py::array::forcecast>(array);
  const auto at = corners.unchecked<2>();
  constexpr std::int64_t kFar = std::numeric_limits<int>::max() / 2;
  const auto is_far = [](std::int64_t place) { return place > kFar || place < -kFar; };
  for (py::ssize_t i = 0; i < at.shape(0); ++i) {
    if (is_far(at(i, 0)) || is_far(at(i, 1)))
      refuse(fmt::format("{}[{}] is outside of every picture", name, i));
    list.push_back({static_cast<int>(at(i, 0)), static_cast<int>(at(i, 1)), n});
  }
}

/// Whether it is one pair of numbers, and not a sequence of pairs.
bool is_pair(py::handle items) {
  if (PySequence_Fast_GET_SIZE(items.ptr()) != 2) return false;
  return PyNumber_Check(PySequence_Fast_GET_ITEM(items.ptr(), 0)) != 0 &&
         PySequence_Check(PySequence_Fast_GET_ITEM(items.ptr(), 0)) == 0;
}

bool read_list(py::handle windows, const char* name, int n, std::vector<Window>& list) {
  const py::object items = items_of(windows);
  if (!items || py::isinstance<py::str>(windows) || py::isinstance<py::bytes>(windows)) {
    refuse(fmt::format("{} is {}; it is a corner (x, y), or corners [(x, y), ...]", name,
                       text_of(windows)));
  }
  if (is_pair(items)) {
    list.push_back(window_of(items, name, 0, n));
    return true;
  }
  const auto count = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(items.ptr()));
  for (std::size_t i = 0; i < count; ++i)
    list.push_back(window_of(PySequence_Fast_GET_ITEM(items.ptr(), i), name, i, n));
  return false;
}

[[noreturn]] void refuse_outside(const Window& window, const std::string& name, int width_px,
                                 int height_px) {
  const int n = window.n;
  if (n > width_px || n > height_px) {
    throw Error(ErrorCode::out_of_bounds,
                fmt::format("metric has windows of {0} x {0} px, and a picture has {1} x {2}; "
                            "give a smaller N",
                            n, width_px, height_px));
  }
  throw Error(
      ErrorCode::out_of_bounds,
      fmt::format("{0} is ({1}, {2}), and {3} x {3} px there cross the edge of a picture "
                  "of {4} x {5} px; ({6}, {7}) fits",
                  name, window.x, window.y, n, width_px, height_px,
                  std::clamp(window.x, 0, width_px - n), std::clamp(window.y, 0, height_px - n)));
}

}  // namespace

Pictures::Pictures(py::handle image, const char* argument) : array_(as_array(image, argument)) {
  require_pixels(argument);
  require_shape(argument);
  use_in_place_or_copy(argument);
}

void Pictures::require_pixels(const char* argument) {
  if (py::hasattr(array_, "mask"))
    refuse(fmt::format("{} is a masked array; give its .data, for every pixel counts", argument));
  array_ = as_pixels(array_);
  const auto& kind = descriptor(array_);
  if (kind.kind == 'u' && (kind.elsize == 1 || kind.elsize == 2)) {
    depth_ = kind.elsize == 1 ? Depth::bits8 : Depth::bits16;
    return;
  }
  refuse(fmt::format("{} has dtype {}; pixels are uint8 or uint16, so scale and convert them first",
                     argument, text_of(array_.dtype())));
}

void Pictures::require_shape(const char* argument) {
  const py::ssize_t axes = array_.ndim();
  if (axes != 2 && axes != 3) {
    refuse(fmt::format("{} has shape {}; a picture has 2 axes (rows, columns), a stack 3", argument,
                       text_of(array_.attr("shape"))));
  }
  if (axes == 3 && array_.shape(2) <= 4) {
    refuse(
        fmt::format("{} has shape {}: its last axis looks like colours; give one grey picture, or "
                    "a stack along the first axis",
                    argument, text_of(array_.attr("shape"))));
  }
  is_stack_ = axes == 3;
  count_ = is_stack_ ? static_cast<std::size_t>(array_.shape(0)) : 1;
  height_ = side(array_.shape(axis(2)), argument);
  width_ = side(array_.shape(axis(1)), argument);
  if (count_ == 0 || width_ == 0 || height_ == 0)
    refuse(fmt::format("{} has shape {}: no pixel", argument, text_of(array_.attr("shape"))));
}

bool Pictures::lies_well() const {
  const py::ssize_t pixel = descriptor(array_).elsize;
  const bool side_by_side = array_.strides(axis(1)) == pixel || width_ == 1;
  return side_by_side && (height_ == 1 || array_.strides(axis(2)) >= width_ * pixel);
}

void Pictures::use_in_place_or_copy(const char* argument) {
  if (!is_native(array_) || !lies_well()) copy(argument);
  data_ = static_cast<const char*>(array_.data());
  const auto row = static_cast<std::size_t>(width_ * descriptor(array_).elsize);
  row_bytes_ = height_ == 1 ? row : static_cast<std::size_t>(array_.strides(axis(2)));
  picture_bytes_ = is_stack_ ? array_.strides(0) : 0;
}

void Pictures::copy(const char* argument) {
  warn_of_copy(argument, is_native(array_) ? "has pixels that do not lie side by side in a row"
                                           : "has the other byte order");
  const py::module_ numpy = py::module_::import("numpy");
  array_ = numpy
               .attr("ascontiguousarray")(array_, depth_ == Depth::bits8
                                                      ? py::dtype::of<std::uint8_t>()
                                                      : py::dtype::of<std::uint16_t>())
               .cast<py::array>();
}

Frame Pictures::frame(std::size_t i) const {
  return Frame::view(data_ + static_cast<py::ssize_t>(i) * picture_bytes_, width_, height_, depth_,
                     row_bytes_);
}

void require_in_picture(const Window& window, const std::string& name, int width_px,
                        int height_px) {
  if (!fits(window, width_px, height_px)) refuse_outside(window, name, width_px, height_px);
}

bool read_windows(py::handle windows, int width_px, int height_px, int n, std::vector<Window>& list,
                  const char* name) {
  if (windows.is_none()) {
    require_in_picture({0, 0, n}, name, width_px, height_px);
    list.push_back(centred_window(width_px, height_px, n));
    return true;
  }
  bool is_one = false;
  if (py::isinstance<py::array>(windows) && py::array::ensure(windows).ndim() != 1) {
    read_array(py::reinterpret_borrow<py::array>(windows), name, n, list);
  } else {
    is_one = read_list(windows, name, n, list);
  }
  if (list.empty()) refuse(fmt::format("{} is empty", name));
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!fits(list[i], width_px, height_px))
      refuse_outside(list[i], is_one ? name : named(name, i), width_px, height_px);
  }
  return is_one;
}

py::array array_of(const Frame& frame) {
  const std::vector<py::ssize_t> shape = {frame.height_px(), frame.width_px()};
  const std::vector<py::ssize_t> strides = {
      static_cast<py::ssize_t>(frame.stride_bytes()),
      static_cast<py::ssize_t>(bytes_per_pixel(frame.depth()))};
  if (frame.depth() == Depth::bits8)
    return py::array_t<std::uint8_t>(shape, strides,
                                     reinterpret_cast<const std::uint8_t*>(frame.row(0)));
  // Rows need not be aligned to 2 bytes; numpy copies them as bytes do.
  return py::array(py::dtype::of<std::uint16_t>(), shape, strides, frame.row(0));
}

Frame frame_holding(const Pictures& pictures, std::size_t i) {
  const Frame seen = pictures.frame(i);
  const std::shared_ptr<const void> owner(new py::array(pictures.array()), [](py::array* array) {
    const py::gil_scoped_acquire lock;
    delete array;
  });
  return Frame::view(seen.row(0), seen.width_px(), seen.height_px(), seen.depth(),
                     seen.stride_bytes(), owner);
}

}  // namespace fathom::python
