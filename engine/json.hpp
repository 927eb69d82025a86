// SPDX-License-Identifier: Apache-2.0
// JSON that others may have written: depth and whole numbers are checked, which nlohmann leaves to
// its caller. Only for the files that read JSON; it takes a compiler long.
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/error.hpp"

namespace fathom {

/// Nobody's file nests deeper; a stack overflows from some ten thousand levels on.
inline constexpr int kDeepestJson = 64;

/// Throws Error(bad_data) for brackets that nest deeper than kDeepestJson outside of strings.
inline void require_shallow_json(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestJson) throw Error(ErrorCode::bad_data, "its brackets nest too deep");
    } else if (c == ']' || c == '}') {
      --depth;
    } else {
      in_string = c == '"';
    }
  }
}

/// Throws Error(bad_data) for what nests too deep, and nlohmann::json::exception.
inline nlohmann::ordered_json parse_json(std::string_view text) {
  require_shallow_json(text);
  return nlohmann::ordered_json::parse(text);
}

/// The whole number that stands there. Throws Error(bad_data) for anything else, and for one that
/// the type does not hold: to convert it would be undefined.
template <std::integral Whole>
Whole whole_from(const nlohmann::ordered_json& json) {
  using Limits = std::numeric_limits<Whole>;
  if (json.is_number_unsigned()) {
    const auto value = json.get<std::uint64_t>();
    if (value <= static_cast<std::uint64_t>(Limits::max())) return static_cast<Whole>(value);
  } else if (json.is_number_integer()) {
    const auto value = json.get<std::int64_t>();
    if (std::is_signed_v<Whole> && value >= static_cast<std::int64_t>(Limits::min()))
      return static_cast<Whole>(value);
  }
  throw Error(ErrorCode::bad_data, "a whole number is out of range, or none");
}

}  // namespace fathom
