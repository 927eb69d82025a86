// SPDX-License-Identifier: Apache-2.0
// Test pictures as frames: packed, or laid out as awkwardly as a caller may.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"
#include "tests/support/patterns.hpp"

namespace fathom::test {

inline Depth depth_of(const Pixels& pixels) {
  return pixels.bits == 8 ? Depth::bits8 : Depth::bits16;
}

/// A frame that owns its pixels, without gaps.
inline Frame to_frame(const Pixels& pixels) {
  if (pixels.bits == 8) {
    return Frame(pixels.width, pixels.height,
                 std::vector<std::uint8_t>(pixels.values.begin(), pixels.values.end()));
  }
  return Frame(pixels.width, pixels.height, pixels.values);
}

/// A frame of one of contents().
inline Frame make_frame(std::string_view content, int bits, int width, int height,
                        std::uint64_t seed) {
  return to_frame(make_pixels(content, bits, width, height, seed));
}

/// The pixels of a window as a frame of their own.
inline Frame cropped(const Frame& frame, const Window& window) {
  const auto* const first =
      frame.row(window.y) + static_cast<std::size_t>(window.x) * bytes_per_pixel(frame.depth());
  return Frame::view(first, window.n, window.n, frame.depth(), frame.stride_bytes()).clone();
}

/// Pixels in read-only memory between two pages that nobody may touch: whoever reads past the last
/// pixel, before the first one, or writes to the picture, crashes here rather than at a user's.
/// Bytes between the rows hold `padding`.
class GuardedFrame {
 public:
  enum class Against { end, start };

  GuardedFrame(const Pixels& pixels, std::size_t stride_bytes, std::uint8_t padding,
               Against against = Against::end) {
    const std::size_t row_bytes = pixels.width * bytes_per_pixel(depth_of(pixels));
    if (stride_bytes < row_bytes) throw std::invalid_argument("stride shorter than a row");
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const std::size_t bytes = stride_bytes * (pixels.height - 1) + row_bytes;
    const std::size_t inner = (bytes + page - 1) / page * page;
    size_ = inner + 2 * page;
    memory_ = static_cast<std::byte*>(
        ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (memory_ == MAP_FAILED) throw std::runtime_error("mmap failed");
    std::byte* const first =
        against == Against::end ? memory_ + page + inner - bytes : memory_ + page;
    std::memset(memory_, padding, size_);
    store(pixels, first, stride_bytes);
    ::mprotect(memory_, size_, PROT_NONE);
    ::mprotect(memory_ + page, inner, PROT_READ);
    frame_ = Frame::view(first, pixels.width, pixels.height, depth_of(pixels), stride_bytes);
  }
  GuardedFrame(const GuardedFrame&) = delete;
  GuardedFrame& operator=(const GuardedFrame&) = delete;
  ~GuardedFrame() { ::munmap(memory_, size_); }

  const Frame& frame() const { return frame_; }

 private:
  static void store(const Pixels& pixels, std::byte* to, std::size_t stride_bytes) {
    for (int y = 0; y < pixels.height; ++y) {
      for (int x = 0; x < pixels.width; ++x) {
        const std::uint16_t value = pixels.at(x, y);
        std::byte* const row = to + y * stride_bytes;
        if (pixels.bits == 8) {
          row[x] = static_cast<std::byte>(value);
        } else {
          std::memcpy(row + 2 * static_cast<std::size_t>(x), &value, sizeof value);
        }
      }
    }
  }

  std::byte* memory_ = nullptr;
  std::size_t size_ = 0;
  Frame frame_;
};

}  // namespace fathom::test
