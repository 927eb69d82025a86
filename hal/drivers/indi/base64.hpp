// SPDX-License-Identifier: Apache-2.0
// Base64 (RFC 4648), decoded as it comes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace fathom::indi {

class Base64Decoder {
 public:
  /// Appends what a piece of text decodes to. White space is skipped; false once anything else
  /// that is not base64 has come.
  bool decode(std::string_view text, std::vector<std::byte>& bytes);

  /// Whether what has come so far could be a whole text: nothing wrong, no group unfinished.
  bool is_complete() const { return !is_bad_ && count_ == 0; }

 private:
  bool take(char c, std::vector<std::byte>& bytes);

  std::uint32_t group_ = 0;  // up to four characters of six bits
  int count_ = 0;            // how many of them have come,
  int padding_ = 0;          // and how many of those are '='
  bool is_over_ = false;     // nothing may follow a padded group
  bool is_bad_ = false;
};

}  // namespace fathom::indi
