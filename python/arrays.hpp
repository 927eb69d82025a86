// SPDX-License-Identifier: Apache-2.0
// Grey pictures in numpy's arrays, looked at where they lie.
#pragma once

#include <pybind11/numpy.h>

#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::python {

namespace py = pybind11;

/// A picture [row][column], or a stack [picture][row][column]. Pixels of 8 or 16 bits that lie side
/// by side in a row are used in place, however far apart rows and pictures are; others are copied
/// once, which the warning fathom.CopyWarning says.
class Pictures {
 public:
  /// argument: what the caller calls the array. Throws Error(bad_argument), naming it, for an array
  /// of another kind or shape.
  Pictures(py::handle image, const char* argument);

  bool is_stack() const { return is_stack_; }
  std::size_t size() const { return count_; }
  int width_px() const { return width_; }
  int height_px() const { return height_; }
  Depth depth() const { return depth_; }

  /// A view of one picture; the array must outlive it. Needs no lock of Python's.
  Frame frame(std::size_t i) const;

  /// The array that the views are of.
  const py::array& array() const { return array_; }

 private:
  void require_pixels(const char* argument);
  void require_shape(const char* argument);
  void use_in_place_or_copy(const char* argument);
  bool lies_well() const;
  void copy(const char* argument);
  py::ssize_t axis(int from_last) const { return array_.ndim() - from_last; }

  py::array array_;
  bool is_stack_ = false;
  std::size_t count_ = 1;
  int width_ = 0, height_ = 0;
  Depth depth_ = Depth::bits8;
  const char* data_ = nullptr;
  std::size_t row_bytes_ = 0;
  py::ssize_t picture_bytes_ = 0;
};

/// Throws Error(out_of_bounds), naming the argument, for a window over a picture's edge.
void require_in_picture(const Window& window, const std::string& name, int width_px, int height_px);

/// Reads an argument such as windows: None (n x n at the centre), one (x, y), a sequence of such pairs, or an integer
/// array of shape (K, 2). Appends to `windows`, and returns whether it is one alone. Throws
/// Error(bad_argument), Error(out_of_bounds), naming the window, for one that is not in the picture.
bool read_windows(py::handle windows, int width_px, int height_px, int n, std::vector<Window>& list,
                  const char* name = "windows");

/// A copy of a frame: uint8 or uint16 of shape (rows, columns).
py::array array_of(const Frame& frame);

/// A frame that holds the array for as long as it lives, in whatever thread that ends.
Frame frame_holding(const Pictures& pictures, std::size_t i);

}  // namespace fathom::python
