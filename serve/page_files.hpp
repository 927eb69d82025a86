// SPDX-License-Identifier: Apache-2.0
// The files of the page, which are part of the program: cmake/EmbedPage.cmake makes the table.
#pragma once

#include <span>
#include <string_view>

namespace fathom::serve {

struct PageFile {
  std::string_view name;  ///< Below serve/page, such as "api.js".
  const char* type;       ///< Its media type.
  std::span<const unsigned char> bytes;
};

/// All of them.
std::span<const PageFile> page_files();

}  // namespace fathom::serve
