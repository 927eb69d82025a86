// SPDX-License-Identifier: Apache-2.0
// Bytes as USB has them: little-endian.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

namespace fathom::usb {

using Bytes = std::vector<std::uint8_t>;

inline void append(Bytes& to, std::initializer_list<int> bytes) {
  for (const int byte : bytes) to.push_back(static_cast<std::uint8_t>(byte));
}

inline void append(Bytes& to, const Bytes& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// The low `size` bytes of a number.
inline void append_number(Bytes& to, std::int64_t value, int size) {
  for (int i = 0; i < size; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// The number in the first `size` bytes, those that are there.
inline std::uint32_t number(std::span<const std::uint8_t> bytes, int size) {
  std::uint32_t value = 0;
  for (int i = 0; i < size && i < static_cast<int>(bytes.size()); ++i) {
    value |= static_cast<std::uint32_t>(bytes[static_cast<std::size_t>(i)]) << (8 * i);
  }
  return value;
}

}  // namespace fathom::usb
