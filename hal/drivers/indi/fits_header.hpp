// SPDX-License-Identifier: Apache-2.0
// The header of a FITS picture (FITS standard 4.0, section 4), read before any library sees it.
//
// Why: cfitsio 4.2 trusts a header. One with a hundred axes makes it free a pointer that whoever
// wrote the picture has chosen. What is read here are the few numbers of a plain picture, and the
// header that cfitsio gets is written anew from them: nothing of the server's own reaches it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fathom::indi {

/// FITS comes in blocks of so many bytes.
inline constexpr std::size_t kFitsBlock = 2880;

/// What a plain picture's header says.
struct FitsHeader {
  int bits = 0;                     ///< BITPIX: 8, 16, 32, 64, -32 or -64.
  std::vector<std::int64_t> sides;  ///< NAXIS1 and so on, 0 or more each; at most kMostAxes.
  double zero = 0;                  ///< BZERO and BSCALE: what is meant is zero + scale * stored.
  double scale = 1;
  std::size_t bytes = 0;  ///< Of the header, whole blocks.

  static constexpr int kMostAxes = 3;

  /// The same as text, and nothing else; whole blocks.
  std::string text() const;
};

/// Reads the header at the beginning of a file. Throws Error(bad_data) for what is no FITS, has no
/// end, or says what a picture cannot be.
FitsHeader read_fits_header(std::span<const std::byte> file);

}  // namespace fathom::indi
