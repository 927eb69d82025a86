// SPDX-License-Identifier: Apache-2.0
// Which plane of a stack with channels, slices and times a page of a picture file is.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pictures/picture.hpp"

namespace fathom::cli {

/// From 0; nothing where the file has but one of a kind.
struct PagePlace {
  std::optional<std::size_t> image, channel, slice, time;
  std::string channel_name;  ///< Or empty.
};

/// What a file tells of a page, or nothing.
PagePlace place_of(const PictureContents& contents, std::size_t page);

/// " (channel 1 GFP, z 3)", or empty.
std::string text_of(const PagePlace& place);

}  // namespace fathom::cli
