// SPDX-License-Identifier: Apache-2.0
// Pictures as INDI cameras send them: FITS in memory, read with cfitsio.
#pragma once

#include <cstddef>
#include <span>

#include "engine/frame.hpp"

namespace fathom::indi {

/// What a picture must be to be taken.
struct ExpectedPicture {
  int width_px = 0;
  int height_px = 0;
  Depth depth = Depth::bits16;
};

/// Reads a grey FITS picture of 8 or 16 bit, unsigned (BZERO 32768) or signed without negative
/// values, rows in the order in which they were sent. A picture of 8 bit fits into one of 16 bit
/// without loss. What follows the picture is left alone. Throws Error(bad_data) for what is damaged,
/// truncated or of another size than expected, before anything of that size is allocated;
/// Error(unsupported), with what to choose instead, for colour planes, floats and 32-bit numbers.
Frame decode_fits(std::span<const std::byte> bytes, const ExpectedPicture& expected);

}  // namespace fathom::indi
