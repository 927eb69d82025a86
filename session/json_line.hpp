// SPDX-License-Identifier: Apache-2.0
// JSON that is written member by member.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace fathom {

/// Appends a JSON number of 17 significant digits, so that a double survives the trip; null for
/// what JSON has no number for.
void append_json(std::string& text, double value);
void append_json(std::string& text, int value);
void append_json(std::string& text, std::size_t value);

/// One JSON object on one line.
class JsonLine {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number> JsonLine& add(std::string_view key, Number value) {
    append_key(key);
    append_json(body_, value);
    return *this;
  }
  JsonLine& add(std::string_view key, std::string_view value);
  JsonLine& add(std::string_view key, const char* value) {
    return add(key, std::string_view(value));
  }
  JsonLine& add(std::string_view key, std::span<const double> values);
  /// A value that there is none of, such as the distance of a run without focus.
  JsonLine& add_null(std::string_view key);
  /// Members that are JSON already: "key":value,...
  JsonLine& add_members(std::string_view members);
  /// A value that is JSON already.
  JsonLine& add_json(std::string_view key, std::string_view value);
  std::string text() const { return "{" + body_ + "}"; }
  /// The text without its braces, for those who put lines together from parts.
  const std::string& body() const { return body_; }

 private:
  void append_key(std::string_view key);
  std::string body_;
};

}  // namespace fathom
