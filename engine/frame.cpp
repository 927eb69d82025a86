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

Frame Frame::view(const void* pixels, int width_px, int height_px, Depth depth,
                  std::size_t stride_bytes, std::shared_ptr<const void> owner) {
  if (owner == nullptr)
    throw Error(ErrorCode::bad_argument, "the owner of a frame's buffer is null");
  Frame frame = view(pixels, width_px, height_px, depth, stride_bytes);
  frame.owned_ = std::move(owner);
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
std::vector<Pixel> rounded_quotients(const std::vector<std::uint64_t>& sums, std::uint64_t count) {
  std::vector<Pixel> quotients;
  quotients.reserve(sums.size());
  for (const std::uint64_t sum : sums) {
    quotients.push_back(static_cast<Pixel>((sum + count / 2) / count));  // rounds half up
  }
  return quotients;
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

void FrameAverage::add(const Frame& frame) {
  if (count_ == 0) {
    width_px_ = frame.width_px();
    height_px_ = frame.height_px();
    depth_ = frame.depth();
    exposure_ = frame.exposure;
    lens_position_ = frame.lens_position;
    sums_.assign(static_cast<std::size_t>(width_px_) * height_px_, 0);
  }
  if (frame.width_px() != width_px_ || frame.height_px() != height_px_ || frame.depth() != depth_) {
    throw Error(ErrorCode::bad_argument, "cannot average frames of different sizes or depths");
  }
  std::uint64_t* sum = sums_.data();
  for (int y = 0; y < height_px_; ++y) {
    for (int x = 0; x < width_px_; ++x) *sum++ += frame.at(x, y);
  }
  exposure_.end_ns = frame.exposure.end_ns;
  ++count_;
}

Frame FrameAverage::mean() const {
  if (count_ == 0) throw Error(ErrorCode::bad_argument, "no frames to average");
  Frame mean = depth_ == Depth::bits8
                   ? Frame(width_px_, height_px_, rounded_quotients<std::uint8_t>(sums_, count_))
                   : Frame(width_px_, height_px_, rounded_quotients<std::uint16_t>(sums_, count_));
  mean.exposure = exposure_;
  mean.lens_position = lens_position_;
  return mean;
}

}  // namespace fathom
