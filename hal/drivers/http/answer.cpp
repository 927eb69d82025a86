// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "engine/error.hpp"

namespace fathom::http {
namespace {

constexpr std::size_t kMostHeadBytes = 16 << 10;

[[noreturn]] void refuse(std::string_view why) {
  throw Error(ErrorCode::bad_data, fmt::format("this is no answer of a fathom serve: {}", why));
}

template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  Number number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::string lower(std::string_view text) {
  std::string made(text);
  for (char& c : made) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return made;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

int status_of(std::string_view line) {
  constexpr std::size_t kBefore = 9, kDigits = 3;  // "HTTP/1.1 200 OK"
  if (!line.starts_with("HTTP/1.") || line.size() < kBefore + kDigits) refuse("it is no HTTP/1.1");
  const std::optional<int> status = number_of<int>(line.substr(kBefore, kDigits));
  if (!status || *status < 200 || *status > 599) refuse("it has no status");
  return *status;
}

}  // namespace

std::string Answer::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

void AnswerReader::read_head(std::string_view head) {
  answer_.emplace();
  std::size_t end = head.find("\r\n");
  answer_->status = status_of(head.substr(0, end));
  while (end < head.size()) {
    const std::size_t begin = end + 2;
    end = std::min(head.find("\r\n", begin), head.size());
    const std::string_view line = head.substr(begin, end - begin);
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) refuse("a header has no colon");
    const std::string name = lower(line.substr(0, colon));
    if (!answer_->headers.emplace(name, trimmed(line.substr(colon + 1))).second &&
        name == "content-length")
      refuse("it says its length twice");
  }
  constexpr int kNoContent = 204;
  const std::string length = answer_->header("content-length");
  const auto bytes = number_of<std::size_t>(length);
  if (!bytes && (answer_->status != kNoContent || !length.empty())) refuse("it says no length");
  length_ = answer_->status == kNoContent ? 0 : *bytes;
  if (length_ > most_bytes_) refuse(fmt::format("{} bytes are too many", length_));
  answer_->goes_on =
      lower(answer_->header("connection")) != "close" && answer_->status != kNoContent;
}

std::optional<Answer> AnswerReader::add(std::string_view piece) {
  bytes_ += piece;
  if (!answer_) {
    const std::size_t end = bytes_.find("\r\n\r\n");
    if (end == std::string::npos) {
      if (bytes_.size() > kMostHeadBytes) refuse("its head has no end");
      return std::nullopt;
    }
    read_head(std::string_view(bytes_).substr(0, end));
    body_at_ = end + 4;
  }
  if (bytes_.size() < body_at_ + length_) return std::nullopt;
  if (bytes_.size() > body_at_ + length_) refuse("it is longer than it says");
  answer_->body = bytes_.substr(body_at_);
  return std::move(answer_);
}

}  // namespace fathom::http
