// SPDX-License-Identifier: Apache-2.0
// What every fuzzer here has in common: any text may be refused with an Error, and with nothing
// else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "engine/error.hpp"

namespace fathom::fuzz {

/// Stops the fuzzer, which keeps the input that led here.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs a parser; true if it took the input. A refusal must be an Error of one line.
template <class Parse>
bool accepted(Parse parse) {
  try {
    parse();
    return true;
  } catch (const Error& error) {
    require(*error.what() != '\0', "an error says something");
    return false;
  }
}

}  // namespace fathom::fuzz
