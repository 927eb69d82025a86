// SPDX-License-Identifier: Apache-2.0
// Which pictures a TIFF holds: its directories, without those marked as previews, and the planes
// that some programs hide behind one directory.
#pragma once

#include <cstdint>
#include <vector>

#include "pictures/tiff_file.hpp"

namespace fathom::pictures {

/// Where one page lies.
struct TiffPage {
  std::uint64_t directory = 0;  ///< Its offset in the file.
  std::uint64_t shift = 0;      ///< Bytes from the directory's own pixels to this page's.
  std::uint16_t sample = 0;     ///< Of its pixels, where samples are pages of their own.
};

struct TiffPages {
  std::vector<TiffPage> pages;
  PictureContents contents;
};

/// Walks the chain of directories once, so that every page is one jump away afterwards. Throws
/// Error(bad_data) for a file that holds nothing but previews, or planes that cannot be reached.
TiffPages list_pages(TiffFile& file);

}  // namespace fathom::pictures
