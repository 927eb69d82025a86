// SPDX-License-Identifier: Apache-2.0
#include "hal/toml.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {
namespace {

/// How deep what follows a character of TOML would lie: brackets, and dots of a key on its line.
class TomlDepth {
 public:
  /// Whether toml++, which descends a level for each, would still have room on its stack.
  bool takes(char c) {
    if (c == '\n') return end_line();
    if (is_comment_) return true;
    if (quote_ != 0) {
      if (!is_escaped_ && c == quote_) quote_ = 0;
      is_escaped_ = quote_ == '"' && c == '\\' && !is_escaped_;
      return true;
    }
    if (c == '"' || c == '\'') quote_ = c;
    is_comment_ = c == '#';
    if (c == '.') ++dots_;
    if (c == '[' || c == '{') ++brackets_;
    if (c == ']' || c == '}') --brackets_;
    constexpr int kDeepest = 64;
    return dots_ + brackets_ <= kDeepest;
  }

 private:
  bool end_line() {
    dots_ = 0;
    quote_ = 0;
    is_comment_ = is_escaped_ = false;
    return true;
  }

  int dots_ = 0, brackets_ = 0;
  char quote_ = 0;
  bool is_comment_ = false, is_escaped_ = false;
};

void require_shallow(std::string_view text, const std::string& where) {
  TomlDepth depth;
  int line = 1;
  for (const char c : text) {
    if (!depth.takes(c))
      throw Error(ErrorCode::bad_data, fmt::format("{} line {}: nests too deep", where, line));
    if (c == '\n') ++line;
  }
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& where) {
  require_shallow(text, where);
  try {
    return toml::parse(text, where);
  } catch (const toml::parse_error& error) {
    throw Error(ErrorCode::bad_data, fmt::format("{} line {}: {}", where, error.source().begin.line,
                                                 error.description()));
  }
}

}  // namespace fathom
