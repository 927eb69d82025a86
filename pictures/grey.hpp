// SPDX-License-Identifier: Apache-2.0
// Colour to grey, exactly.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pictures/picture.hpp"

namespace fathom::pictures {

/// BT.601 luma, rounded to nearest, in integers so that it is the same everywhere.
template <class Sample>
constexpr Sample luma(Sample red, Sample green, Sample blue) {
  const std::uint32_t sum = 299u * red + 587u * green + 114u * blue;
  return static_cast<Sample>((sum + 500u) / 1000u);
}

/// The grey that a colour becomes.
template <class Sample>
constexpr Sample grey_of(Colour colour, Sample red, Sample green, Sample blue) {
  switch (colour) {
    case Colour::luma:
      return luma(red, green, blue);
    case Colour::red:
      return red;
    case Colour::green:
      return green;
    case Colour::blue:
      return blue;
  }
  return 0;
}

/// One row of interleaved samples to grey: 1 channel is copied, 3 become what `colour` says.
template <class Sample>
void grey_row(const Sample* samples, std::size_t width_px, int channels, Colour colour,
              Sample* grey) {
  if (channels == 1) {
    std::copy_n(samples, width_px, grey);
    return;
  }
  for (std::size_t x = 0; x < width_px; ++x) {
    const Sample* pixel = samples + x * static_cast<std::size_t>(channels);
    grey[x] = grey_of(colour, pixel[0], pixel[1], pixel[2]);
  }
}

/// Where the rows of a picture go: to its greys, and to its colours where somebody keeps them.
template <class Sample>
class PixelSink {
 public:
  /// channels: 1 for grey, 3 for colours. colours: null, or where they go; it must outlive this.
  PixelSink(const PictureShape& shape, int channels, Colour colour, Colours* colours)
      : shape_(shape), channels_(channels), colour_(colour) {
    const std::size_t pixels = width() * static_cast<std::size_t>(shape.height_px);
    grey_.resize(pixels);
    if (colours == nullptr || channels != 3) return;
    colours_ = &colours->of<Sample>();
    colours_->resize(3 * pixels);
  }

  /// One row of interleaved samples. Never throws, because the C libraries' loops call it.
  void put(std::size_t y, const Sample* samples) noexcept {
    grey_row(samples, width(), channels_, colour_, grey_.data() + y * width());
    if (colours_ != nullptr) std::copy_n(samples, 3 * width(), colours_->data() + 3 * y * width());
  }

  /// The grey values; to be called once, at the end.
  std::vector<Sample> take_grey() { return std::move(grey_); }
  Frame take() { return Frame(shape_.width_px, shape_.height_px, std::move(grey_)); }

 private:
  std::size_t width() const { return static_cast<std::size_t>(shape_.width_px); }

  PictureShape shape_;
  int channels_;
  Colour colour_;
  std::vector<Sample> grey_;
  std::vector<Sample>* colours_ = nullptr;
};

}  // namespace fathom::pictures
