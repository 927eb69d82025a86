// SPDX-License-Identifier: Apache-2.0
// What programs write about the planes of a stack into the description of its first page.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pictures/picture.hpp"

namespace fathom::pictures {

/// What a description in plain text promises.
struct DescribedStack {
  std::size_t images = 1;
  PictureStack stack;  ///< Its pages are empty where the description says nothing that makes sense.
};

/// ImageJ's description: "ImageJ=1.53t\nimages=14\nchannels=2\nslices=7\n...". Channels change
/// fastest, times slowest. Nothing for another text.
std::optional<DescribedStack> parse_imagej(std::string_view description);

/// tifffile's: {"shape": [4, 14, 2, 96, 96], "axes": "TZCYX"}. Nothing for another text, or one whose
/// axes are not all of T, Z, C, Y, X and S, the last three at its end.
std::optional<DescribedStack> parse_shaped(std::string_view description);

/// Whether a description is an OME-XML document.
bool is_ome(std::string_view description);

/// The stacks (images) of an OME-XML document (OME schema 2016-06, and older ones that say the
/// same). own_name: the file that holds it; planes that lie in others are missing.
/// page_of_directory: the page of each directory of the file, or kMissing. Empty for a document
/// that says nothing of planes; nothing for one that is damaged, or says what cannot be.
std::optional<std::vector<PictureStack>> parse_ome(std::string_view description,
                                                   std::string_view own_name,
                                                   std::span<const std::size_t> page_of_directory);

/// Micrometres of a length in a unit such as "um", "micron" or "nm"; nothing for another unit.
std::optional<double> micrometres(double length, std::string_view unit);

}  // namespace fathom::pictures
