// SPDX-License-Identifier: Apache-2.0
#include "engine/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace fathom {
namespace {

constexpr bool is_plain(unsigned char byte) { return byte >= 0x20 && byte < 0x7f; }

/// A character of several bytes, as UTF-8 spells it.
struct Character {
  std::size_t bytes = 0;  ///< 0: it is none.
  std::uint32_t code = 0;
};

Character character_at(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte & 0xc0U) != 0x80U) return {};
    code = code << 6U | (byte & 0x3fU);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kLeast[bytes] || code > 0x10ffff || is_surrogate) return {};
  return {bytes, code};
}

/// Controls of eight bits, marks and overrides of direction, separators of lines and paragraphs.
bool is_command(std::uint32_t code) {
  return code < 0xa0 || code == 0x61c || (code >= 0x200e && code <= 0x200f) ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string printable(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const auto* const odd = std::find_if_not(text.begin(), text.end(), is_plain);
    line.append(text.begin(), odd);
    text.remove_prefix(static_cast<std::size_t>(odd - text.begin()));
    if (text.empty()) break;
    const Character found = character_at(text);
    const std::size_t bytes = std::max<std::size_t>(found.bytes, 1);
    if (found.bytes > 0 && !is_command(found.code)) {
      line += text.substr(0, bytes);
    } else {
      for (const char c : text.substr(0, bytes))
        fmt::format_to(std::back_inserter(line), "\\x{:02x}", static_cast<unsigned char>(c));
    }
    text.remove_prefix(bytes);
  }
  return line;
}

}  // namespace fathom
