// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/indi/base64.hpp"

namespace fathom::indi {
namespace {

/// The six bits of a character, or -1.
int sextet(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

bool is_space(char c) { return c == '\n' || c == '\r' || c == ' ' || c == '\t'; }

}  // namespace

bool Base64Decoder::take(char c, std::vector<std::byte>& bytes) {
  const bool is_padding = c == '=';
  const int bits = is_padding ? 0 : sextet(c);
  if (is_over_ || bits < 0 || (is_padding ? count_ < 2 : padding_ > 0)) return false;
  group_ = group_ << 6 | static_cast<std::uint32_t>(bits);
  padding_ += is_padding ? 1 : 0;
  if (++count_ < 4) return true;
  for (int i = 0; i < 3 - padding_; ++i) {
    bytes.push_back(static_cast<std::byte>(group_ >> (16 - 8 * i) & 0xFF));
  }
  is_over_ = padding_ > 0;
  group_ = 0;
  count_ = 0;
  return true;
}

bool Base64Decoder::decode(std::string_view text, std::vector<std::byte>& bytes) {
  for (const char c : text) {
    if (is_bad_) return false;
    if (!is_space(c)) is_bad_ = !take(c, bytes);
  }
  return !is_bad_;
}

}  // namespace fathom::indi
