// SPDX-License-Identifier: Apache-2.0
// TIFFs put together byte by byte, for what libtiff's writer would not write.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fathom::test {

struct RawPage {
  std::uint32_t width = 4, height = 2, bits = 8;
  std::string pixels = {};  ///< As they stand in the file, one strip.
  std::string description = {};
  std::map<std::uint32_t, std::uint32_t> fields = {};  ///< More of them, or other values.
};

/// Each page is its directory, its description and its pixels; the next one follows.
inline std::string raw_tiff(const std::vector<RawPage>& pages, bool big_endian = false) {
  std::string file;
  const auto put = [&](std::uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i)
      file += static_cast<char>(value >> (8 * (big_endian ? bytes - 1 - i : i)));
  };
  file = big_endian ? "MM" : "II";
  put(42, 2);
  put(8, 4);
  for (std::size_t p = 0; p < pages.size(); ++p) {
    const RawPage& page = pages[p];
    std::map<std::uint32_t, std::uint32_t> fields = {
        {256, page.width}, {257, page.height}, {258, page.bits},  {259, 1},
        {262, 1},          {277, 1},           {278, page.height}};
    fields[279] = static_cast<std::uint32_t>(page.pixels.size());
    fields[273] = 0;
    if (!page.description.empty()) fields[270] = 0;
    for (const auto& [tag, value] : page.fields) fields[tag] = value;
    const auto behind = static_cast<std::uint32_t>(file.size() + 2 + 12 * fields.size() + 4);
    const auto length = static_cast<std::uint32_t>(page.description.size() + 1);
    const std::uint32_t pixels = behind + (page.description.empty() ? 0 : length);
    if (!page.fields.contains(273)) fields[273] = pixels;
    put(static_cast<std::uint32_t>(fields.size()), 2);
    for (const auto& [tag, value] : fields) {
      const bool is_text = tag == 270;
      put(tag, 2);
      put(is_text ? 2 : 4, 2);
      put(is_text ? length : 1, 4);
      put(is_text ? behind : value, 4);
    }
    const auto end = static_cast<std::uint32_t>(pixels + page.pixels.size());
    put(p + 1 < pages.size() ? end : 0, 4);
    if (!page.description.empty()) file += page.description + '\0';
    file += page.pixels;
  }
  return file;
}

}  // namespace fathom::test
