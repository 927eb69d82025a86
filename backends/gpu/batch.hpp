// SPDX-License-Identifier: Apache-2.0
// The pixels and windows of one upload, as kernels read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/frame.hpp"
#include "engine/window.hpp"

namespace fathom::gpu {

/// Part of a frame: what has to be uploaded for some windows, once however much they overlap.
struct Rectangle {
  int x = 0, y = 0, right = 0, bottom = 0;  ///< Half open; empty while right is 0.

  /// Grows to hold the window.
  void include(const Window& window);
  /// Rows are packed, each from a multiple of four bytes on.
  std::size_t stride_bytes(Depth depth) const;
  std::size_t bytes(Depth depth) const;

  /// Copies the pixels to bytes(depth) of packed rows.
  void copy(const Frame& frame, std::byte* packed) const;
  /// Where the window's first pixel lies among them, in bytes.
  std::uint32_t origin(const Window& window, Depth depth) const;

  bool operator==(const Rectangle&) const = default;
};

/// Windows that are scored in one go.
struct Batch {
  Rectangle part;                  ///< Holds every window.
  std::vector<std::uint32_t> ids;  ///< Which of the call's windows, by number.
};

/// Cuts a call into batches of at most `most` windows whose parts take at most `room` bytes. Where
/// the frame is larger than that, windows are taken from its top to its bottom, so that few pixels
/// are uploaded twice. A single window is never cut, whatever the room.
std::vector<Batch> cut(std::span<const Window> windows, Depth depth, std::size_t most,
                       std::size_t room);

}  // namespace fathom::gpu
