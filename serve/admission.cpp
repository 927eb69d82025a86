// SPDX-License-Identifier: Apache-2.0
#include "serve/admission.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>

#include "engine/error.hpp"

namespace fathom::serve {
namespace {

struct Notice {
  Refusal refusal;
  int status;
  const char* code;
  const char* words;
};

constexpr Notice kNotices[] = {
    {Refusal::none, 200, "none", ""},
    {Refusal::method, 405, "method", "use GET, HEAD or POST"},
    {Refusal::long_path, 414, "long_path", "the address is longer than any that there is"},
    {Refusal::foreign_host, 421, "foreign_host",
     "the Host header is not a name of this service; use its number or localhost, or start it with "
     "--name NAME"},
    {Refusal::foreign_origin, 403, "foreign_origin",
     "the request comes from a page of another site (Origin header)"},
    {Refusal::no_token, 401, "no_token",
     "this needs the token: open the address that fathom serve printed, or send the header "
     "\"Authorization: Bearer TOKEN\""},
    {Refusal::body_of_get, 400, "body_of_get", "a GET has no body"},
    {Refusal::no_length, 411, "no_length", "send the body in one piece, with a Content-Length"},
    {Refusal::unclear_length, 400, "unclear_length", "the Content-Length is no number"},
    {Refusal::large_body, 413, "large_body", "a body has 65536 bytes at most"},
    {Refusal::not_json, 415, "not_json", "send JSON, with \"Content-Type: application/json\""},
};

const Notice& notice_of(Refusal refusal) {
  return *std::ranges::find(kNotices, refusal, &Notice::refusal);
}

std::string lower(std::string_view text) {
  std::string lowered(text);
  std::ranges::transform(lowered, lowered.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lowered;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

bool is_number(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return ::inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The host without its port; nothing where it is neither.
std::optional<std::string> host_alone(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view rest = host.substr(end + 1);
    if (!rest.empty() && !(rest[0] == ':' && is_port(rest.substr(1)))) return std::nullopt;
    return lower(host.substr(1, end - 1));
  }
  const std::size_t colon = host.find(':');
  if (colon != std::string_view::npos && !is_port(host.substr(colon + 1))) return std::nullopt;
  return lower(host.substr(0, colon));
}

bool is_foreign_host(const Visitor& visitor, const House& house) {
  return visitor.hosts.size() != 1 || !is_our_host(visitor.hosts[0], house.names);
}

/// What asks must have come from here, where it says where it comes from.
bool is_foreign_origin(const Visitor& visitor) {
  return std::ranges::any_of(visitor.origins, [&](const std::string& origin) {
    return lower(origin) != "http://" + lower(visitor.hosts[0]);
  });
}

Refusal admit_body(const Visitor& visitor) {
  if (visitor.is_chunked || visitor.lengths.empty()) return Refusal::no_length;
  if (visitor.lengths.size() > 1) return Refusal::unclear_length;
  const std::string_view text = visitor.lengths[0];
  std::size_t length = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (problem == std::errc::result_out_of_range) return Refusal::large_body;
  if (problem != std::errc() || end != text.data() + text.size()) return Refusal::unclear_length;
  if (length > kMostBodyBytes) return Refusal::large_body;
  return is_json(visitor.content_type) ? Refusal::none : Refusal::not_json;
}

}  // namespace

bool same_secret(std::string_view a, std::string_view b) {
  // Every byte of `a` is compared, with whatever of `b` there is.
  unsigned different = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    different |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(other);
  }
  return different == 0 && !b.empty();
}

std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = cookies.find(';');
    const std::string_view one = trimmed(cookies.substr(0, end));
    if (one.size() > name.size() && one.starts_with(name) && one[name.size()] == '=')
      return one.substr(name.size() + 1);
    cookies = end == std::string_view::npos ? std::string_view() : cookies.substr(end + 1);
  }
  return {};
}

bool has_token(const Visitor& visitor, const House& house) {
  constexpr std::string_view kBearer = "bearer ";
  const std::string_view said = visitor.authorization;
  const bool has_bearer = lower(said.substr(0, kBearer.size())) == kBearer;
  const std::string_view bearer = has_bearer ? trimmed(said.substr(kBearer.size())) : "";
  return same_secret(bearer, house.token) || same_secret(visitor.query_token, house.token) ||
         same_secret(cookie_value(visitor.cookie, house.cookie_name), house.token);
}

bool is_our_host(std::string_view host, const std::vector<std::string>& names) {
  const std::optional<std::string> alone = host_alone(host);
  if (!alone || alone->empty()) return false;
  return *alone == "localhost" || is_number(*alone) ||
         std::ranges::find(names, *alone) != names.end();
}

bool is_json(std::string_view content_type) {
  return lower(trimmed(content_type.substr(0, content_type.find(';')))) == "application/json";
}

bool is_client_name(std::string_view name) {
  constexpr std::size_t kLongest = 64;
  return !name.empty() && name.size() <= kLongest && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-';
  });
}

Refusal admit(const Visitor& visitor, const House& house) {
  const bool is_post = visitor.method == "POST";
  if (!is_post && visitor.method != "GET" && visitor.method != "HEAD") return Refusal::method;
  if (visitor.path.size() > kLongestPath) return Refusal::long_path;
  if (is_foreign_host(visitor, house)) return Refusal::foreign_host;
  if (is_foreign_origin(visitor)) return Refusal::foreign_origin;
  if (!has_token(visitor, house)) return Refusal::no_token;
  if (is_post) return admit_body(visitor);
  const bool has_body =
      visitor.is_chunked ||
      std::ranges::any_of(visitor.lengths, [](const auto& length) { return length != "0"; });
  return has_body ? Refusal::body_of_get : Refusal::none;
}

int status_of(Refusal refusal) { return notice_of(refusal).status; }
const char* code_of(Refusal refusal) { return notice_of(refusal).code; }
const char* words_of(Refusal refusal) { return notice_of(refusal).words; }

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error(ErrorCode::unavailable, "the system gives no random numbers for a token");
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

void require_token(std::string_view token) {
  constexpr std::size_t kShortest = 8, kLongest = 128;
  const bool is_plain = std::ranges::all_of(
      token, [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
  if (is_plain && token.size() >= kShortest && token.size() <= kLongest) return;
  throw Error(ErrorCode::bad_argument,
              "a token has 8 to 128 letters, digits, hyphens and underscores; leave it out, and "
              "one is drawn");
}

}  // namespace fathom::serve
