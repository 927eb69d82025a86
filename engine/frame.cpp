// SPDX-License-Identifier: Apache-2.0
#include "engine/frame.hpp"

#include <fmt/format.h>

#include <utility>

#include "engine/error.hpp"

namespace fathom {

void Frame::check_shape(std::size_t pixel_count) const {
  if (width_px_ <= 0 || height_px_ <= 0) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a frame of {} x {} px has no pixels", width_px_, height_px_));
  }
  const std::size_t wanted = static_cast<std::size_t>(width_px_) * height_px_;
  if (pixel_count != wanted) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a frame of {} x {} px needs {} pixels, got {}", width_px_, height_px_,
                            wanted, pixel_count));
  }
}

Frame::Frame(int width_px, int height_px, std::vector<std::uint8_t> pixels)
    : width_px_(width_px), height_px_(height_px), depth_(Depth::bits8) {
  check_shape(pixels.size());
  stride_bytes_ = static_cast<std::size_t>(width_px);
  const auto& stored = owned_.emplace<std::vector<std::uint8_t>>(std::move(pixels));
  data_ = reinterpret_cast<const std::byte*>(stored.data());
}

Frame::Frame(int width_px, int height_px, std::vector<std::uint16_t> pixels)
    : width_px_(width_px), height_px_(height_px), depth_(Depth::bits16) {
  check_shape(pixels.size());
  stride_bytes_ = 2 * static_cast<std::size_t>(width_px);
  const auto& stored = owned_.emplace<std::vector<std::uint16_t>>(std::move(pixels));
  data_ = reinterpret_cast<const std::byte*>(stored.data());
}

Frame Frame::view(const void* pixels, int width_px, int height_px, Depth depth,
                  std::size_t stride_bytes) {
  if (pixels == nullptr) throw Error(ErrorCode::bad_argument, "a frame's buffer is null");
  if (width_px <= 0 || height_px <= 0) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a frame of {} x {} px has no pixels", width_px, height_px));
  }
  const std::size_t row_bytes = static_cast<std::size_t>(width_px) * bytes_per_pixel(depth);
  if (stride_bytes < row_bytes) {
    throw Error(ErrorCode::bad_argument,
                fmt::format("a row of {} pixels takes {} bytes, but the stride is only {}",
                            width_px, row_bytes, stride_bytes));
  }
  Frame frame;
  frame.data_ = static_cast<const std::byte*>(pixels);
  frame.width_px_ = width_px;
  frame.height_px_ = height_px;
  frame.depth_ = depth;
  frame.stride_bytes_ = stride_bytes;
  return frame;
}

// Moving a vector keeps its elements where they are, so data_ stays valid in the new frame.
Frame::Frame(Frame&& other) noexcept { *this = std::move(other); }

Frame& Frame::operator=(Frame&& other) noexcept {
  if (this == &other) return *this;
  exposure = other.exposure;
  lens_position = other.lens_position;
  owned_ = std::move(other.owned_);
  data_ = std::exchange(other.data_, nullptr);
  width_px_ = std::exchange(other.width_px_, 0);
  height_px_ = std::exchange(other.height_px_, 0);
  depth_ = other.depth_;
  stride_bytes_ = std::exchange(other.stride_bytes_, 0);
  other.owned_ = std::monostate{};
  return *this;
}

namespace {

template <class Pixel>
std::vector<Pixel> packed_pixels(const Frame& frame) {
  const std::size_t width = static_cast<std::size_t>(frame.width_px());
  std::vector<Pixel> pixels(width * frame.height_px());
  for (int y = 0; y < frame.height_px(); ++y) {
    std::memcpy(pixels.data() + y * width, frame.row(y), width * sizeof(Pixel));
  }
  return pixels;
}

template <class Pixel>
std::vector<Pixel> mean_pixels(const std::vector<Frame>& frames) {
  const Frame& first = frames.front();
  const std::size_t width = static_cast<std::size_t>(first.width_px());
  const std::uint64_t count = frames.size();
  std::vector<Pixel> mean(width * first.height_px());
  for (int y = 0; y < first.height_px(); ++y) {
    for (int x = 0; x < first.width_px(); ++x) {
      std::uint64_t sum = count / 2;  // rounds half up
      for (const Frame& frame : frames) sum += frame.at(x, y);
      mean[y * width + x] = static_cast<Pixel>(sum / count);
    }
  }
  return mean;
}

}  // namespace

Frame Frame::clone() const {
  if (empty()) return Frame();
  Frame copy = depth_ == Depth::bits8
                   ? Frame(width_px_, height_px_, packed_pixels<std::uint8_t>(*this))
                   : Frame(width_px_, height_px_, packed_pixels<std::uint16_t>(*this));
  copy.exposure = exposure;
  copy.lens_position = lens_position;
  return copy;
}

Frame average(const std::vector<Frame>& frames) {
  if (frames.empty()) throw Error(ErrorCode::bad_argument, "no frames to average");
  const Frame& first = frames.front();
  for (const Frame& frame : frames) {
    if (frame.width_px() != first.width_px() || frame.height_px() != first.height_px() ||
        frame.depth() != first.depth()) {
      throw Error(ErrorCode::bad_argument, "cannot average frames of different sizes or depths");
    }
  }
  Frame mean = first.depth() == Depth::bits8
                   ? Frame(first.width_px(), first.height_px(), mean_pixels<std::uint8_t>(frames))
                   : Frame(first.width_px(), first.height_px(), mean_pixels<std::uint16_t>(frames));
  mean.exposure = {first.exposure.start_ns, frames.back().exposure.end_ns};
  mean.lens_position = first.lens_position;
  return mean;
}

}  // namespace fathom
