// SPDX-License-Identifier: Apache-2.0
// An answer of HTTP/1.1, read from bytes that somebody else sent.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace fathom::http {

struct Answer {
  int status = 0;
  std::map<std::string, std::string> headers;  ///< Names in lower case.
  std::string body;
  bool goes_on = false;  ///< Whether the connection takes another request.

  /// Empty where there is none.
  std::string header(const std::string& name) const;
};

/// Puts an answer together from pieces as they come.
class AnswerReader {
 public:
  /// most_bytes: of the body.
  explicit AnswerReader(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Takes the next piece, and returns the answer once it is whole. Throws Error(bad_data) for what
  /// is no HTTP, says no length, or is too large. Nothing may follow a whole answer.
  std::optional<Answer> add(std::string_view piece);

  bool has_begun() const { return !bytes_.empty(); }

 private:
  void read_head(std::string_view head);

  std::size_t most_bytes_;
  std::string bytes_;
  std::optional<Answer> answer_;  ///< From the head on.
  std::size_t body_at_ = 0, length_ = 0;
};

}  // namespace fathom::http
