// SPDX-License-Identifier: Apache-2.0
#include "session/json_line.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/printable.hpp"

namespace fathom {
namespace {

/// As printable() would have it, and JSON still.
std::string quoted(std::string_view text) {
  const bool is_harmless = printable(text) == text;
  return nlohmann::json(text).dump(-1, ' ', !is_harmless, nlohmann::json::error_handler_t::replace);
}

template <typename Integer>
void append_integer(std::string& text, Integer value) {
  std::array<char, 24> digits;
  const auto [end, problem] = std::to_chars(digits.begin(), digits.end(), value);
  text.append(digits.begin(), end);
}

}  // namespace

void append_json(std::string& text, double value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  constexpr int kDigits = std::numeric_limits<double>::max_digits10;
  std::array<char, 32> digits;  // sign, 17 digits, point, e-308
  const auto [end, problem] =
      std::to_chars(digits.begin(), digits.end(), value, std::chars_format::general, kDigits);
  text.append(digits.begin(), end);
}
void append_json(std::string& text, int value) { append_integer(text, value); }
void append_json(std::string& text, std::size_t value) { append_integer(text, value); }

void JsonLine::append_key(std::string_view key) {
  if (!body_.empty()) body_ += ',';
  body_ += quoted(key);
  body_ += ':';
}

JsonLine& JsonLine::add(std::string_view key, std::string_view value) {
  append_key(key);
  body_ += quoted(value);
  return *this;
}
JsonLine& JsonLine::add(std::string_view key, std::span<const double> values) {
  append_key(key);
  body_ += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) body_ += ',';
    append_json(body_, values[i]);
  }
  body_ += ']';
  return *this;
}
JsonLine& JsonLine::add_members(std::string_view members) {
  if (!body_.empty()) body_ += ',';
  body_ += members;
  return *this;
}
JsonLine& JsonLine::add_json(std::string_view key, std::string_view value) {
  append_key(key);
  body_ += value;
  return *this;
}
JsonLine& JsonLine::add_null(std::string_view key) {
  append_key(key);
  body_ += "null";
  return *this;
}

}  // namespace fathom
