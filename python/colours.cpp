// SPDX-License-Identifier: Apache-2.0
#include "python/colours.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "pictures/grey.hpp"
#include "python/errors.hpp"

namespace fathom::python {
namespace {

template <class Sample>
mapping::ColourPicture copied(const py::array& image) {
  const py::array_t<Sample, py::array::c_style | py::array::forcecast> samples(image);
  const auto at = samples.template unchecked<3>();
  const auto pixels = static_cast<std::size_t>(at.shape(0) * at.shape(1));
  mapping::ColourPicture picture;
  std::vector<Sample>& colours = picture.colours.of<Sample>();
  std::vector<Sample> greys;
  colours.reserve(3 * pixels);
  greys.reserve(pixels);
  for (py::ssize_t y = 0; y < at.shape(0); ++y) {
    for (py::ssize_t x = 0; x < at.shape(1); ++x) {
      const Sample red = at(y, x, 0), green = at(y, x, 1), blue = at(y, x, 2);
      colours.insert(colours.end(), {red, green, blue});
      greys.push_back(pictures::luma(red, green, blue));
    }
  }
  picture.grey =
      Frame(static_cast<int>(at.shape(1)), static_cast<int>(at.shape(0)), std::move(greys));
  return picture;
}

}  // namespace

bool is_coloured(py::handle image) {
  if (!py::isinstance<py::array>(image)) return false;
  const auto array = py::reinterpret_borrow<py::array>(image);
  return array.ndim() == 3 && (array.shape(2) == 3 || array.shape(2) == 4);
}

mapping::ColourPicture colour_picture(const py::array& image, const std::string& argument) {
  const py::dtype type = image.dtype();
  if (type.kind() == 'u' && type.itemsize() == 1) return copied<std::uint8_t>(image);
  if (type.kind() == 'u' && type.itemsize() == 2) return copied<std::uint16_t>(image);
  const std::string given = py::str(static_cast<py::object>(type));
  refuse(
      fmt::format("{} has dtype {}; colours are uint8 or uint16, so scale and convert them first",
                  argument, given));
}

}  // namespace fathom::python
