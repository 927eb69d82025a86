// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/http/place.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/error.hpp"

namespace fathom::http {
namespace {

/// The message leaves out what follows the question mark, which may be a secret.
[[noreturn]] void refuse(std::string_view text, std::string_view why) {
  throw Error(
      ErrorCode::bad_argument,
      fmt::format("\"{}\" is no address of a fathom serve: {}; write what it prints, such as "
                  "http://pi:8470?token=TOKEN",
                  text.substr(0, text.find('?')), why));
}

bool is_token(std::string_view token) {
  return std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c < '\x7f'; });
}

}  // namespace

Place parse_place(std::string_view text) {
  std::string_view rest = text;
  if (rest.starts_with("https:")) refuse(text, "it speaks plain HTTP (an SSH tunnel hides it)");
  if (rest.starts_with("http:")) rest.remove_prefix(5);
  if (!rest.starts_with("//")) refuse(text, "two slashes stand before the name of the computer");
  rest.remove_prefix(2);
  const std::size_t question = std::min(rest.find('?'), rest.size());
  std::string_view query = rest.substr(std::min(question + 1, rest.size()));
  std::string_view host = rest.substr(0, question);
  if (host.ends_with('/')) host.remove_suffix(1);
  const std::optional<Address> address = parse_address(host, kUsualPort);
  if (!address || host.find_first_of("/@") != std::string_view::npos)
    refuse(text, "no name of a computer, or no port");
  if (!query.empty() && !query.starts_with("token="))
    refuse(text, "behind the question mark stands token=TOKEN alone");
  query.remove_prefix(std::min<std::size_t>(query.size(), 6));
  if (!is_token(query)) refuse(text, "its token has signs that no token has");
  return {.address = *address, .token = std::string(query)};
}

}  // namespace fathom::http
