// SPDX-License-Identifier: Apache-2.0
// Pixels, and when and where they were taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace fathom {

/// Bits of a grey pixel as stored. A 10- or 12-bit camera delivers Depth::bits16, not rescaled.
enum class Depth { bits8 = 8, bits16 = 16 };

/// Bytes that one pixel of this depth takes.
constexpr std::size_t bytes_per_pixel(Depth depth) { return depth == Depth::bits8 ? 1 : 2; }

/// When a frame's pixels gathered light, in nanoseconds of the rig's monotonic clock
/// (CLOCK_MONOTONIC for real cameras, the simulation's own clock for simulated ones). Zero when
/// unknown.
struct Exposure {
  std::int64_t start_ns = 0;
  std::int64_t end_ns = 0;
};

/// A grey picture of 8- or 16-bit pixels in native byte order: owned, or a view of somebody else's
/// buffer. Immutable once made. Rows may be any number of bytes apart, so a row of 16-bit pixels
/// need not be aligned: read it with `row()` and memcpy, or with `at()`. Move-only, because a frame
/// is large; `clone()` copies on purpose.
class Frame {
 public:
  Frame() = default;

  /// Takes ownership of width * height pixels, row by row without gaps.
  /// Throws Error(bad_argument) if the count does not match or a side is not positive.
  Frame(int width_px, int height_px, std::vector<std::uint8_t> pixels);
  Frame(int width_px, int height_px, std::vector<std::uint16_t> pixels);

  /// Looks at a caller's buffer, which must outlive the frame; nothing is copied.
  /// stride_bytes: distance between the starts of two rows, at least one row of pixels.
  /// Throws Error(bad_argument) for a null buffer, a side that is not positive or a short stride.
  static Frame view(const void* pixels, int width_px, int height_px, Depth depth,
                    std::size_t stride_bytes);

  /// The same of a buffer that lives as long as `owner` does (an array of another language, a
  /// camera's buffer, a mapped file). The frame holds it and lets go of it at its end; clone() does
  /// not. Throws Error(bad_argument) for a null owner too.
  static Frame view(const void* pixels, int width_px, int height_px, Depth depth,
                    std::size_t stride_bytes, std::shared_ptr<const void> owner);

  Frame(Frame&& other) noexcept;
  Frame& operator=(Frame&& other) noexcept;
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;
  ~Frame() = default;

  /// An owned copy without gaps between rows, with the same exposure and lens position.
  Frame clone() const;

  int width_px() const { return width_px_; }
  int height_px() const { return height_px_; }
  Depth depth() const { return depth_; }
  std::size_t stride_bytes() const { return stride_bytes_; }
  bool empty() const { return data_ == nullptr; }

  /// First byte of row y, 0 <= y < height_px(). Unchecked.
  const std::byte* row(int y) const { return data_ + static_cast<std::size_t>(y) * stride_bytes_; }

  /// Grey value of one pixel, 0..255 or 0..65535. Unchecked.
  std::uint32_t at(int x, int y) const {
    const std::byte* p = row(y) + static_cast<std::size_t>(x) * bytes_per_pixel(depth_);
    if (depth_ == Depth::bits8) return std::to_integer<std::uint32_t>(*p);
    std::uint16_t value;
    std::memcpy(&value, p, sizeof value);
    return value;
  }

  Exposure exposure;                    ///< When it was taken.
  std::optional<double> lens_position;  ///< Where the lens stood, in the lens's own unit, if known.

 private:
  void check_shape(std::size_t pixel_count) const;

  std::variant<std::monostate, std::vector<std::uint8_t>, std::vector<std::uint16_t>,
               std::shared_ptr<const void>>
      owned_;
  const std::byte* data_ = nullptr;
  int width_px_ = 0;
  int height_px_ = 0;
  Depth depth_ = Depth::bits8;
  std::size_t stride_bytes_ = 0;
};

/// The pixel-wise mean of frames of one shape, taken one at a time so that a thousand cost no more
/// memory than two (thesis T12: ten frames averaged halve the random noise's share).
class FrameAverage {
 public:
  /// Throws Error(bad_argument) for a frame of another size or depth than the first.
  void add(const Frame& frame);

  /// Rounded to the nearest grey value; exposure from the first frame's start to the last one's
  /// end, lens position of the first. Throws Error(bad_argument) if nothing was added.
  Frame mean() const;

 private:
  std::vector<std::uint64_t> sums_;
  std::uint64_t count_ = 0;
  int width_px_ = 0;
  int height_px_ = 0;
  Depth depth_ = Depth::bits8;
  Exposure exposure_;
  std::optional<double> lens_position_;
};

}  // namespace fathom
