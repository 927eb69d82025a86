// SPDX-License-Identifier: Apache-2.0
// Who is let in: decided of a request's head alone, before anything else of it is read.
//
// A page of somebody else in the same browser can send requests to this computer, and may make its
// own name point here (DNS rebinding). It can neither read the token nor choose the headers Host
// and Origin.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::serve {

/// The largest body that a request may have.
inline constexpr std::size_t kMostBodyBytes = 64 << 10;
/// The longest path; every one of ours is shorter by far.
inline constexpr std::size_t kLongestPath = 256;

/// What a request says of itself.
struct Visitor {
  std::string method;
  std::string path;
  std::vector<std::string> hosts;    ///< Every Host header.
  std::vector<std::string> origins;  ///< Every Origin header.
  std::string content_type;
  std::vector<std::string> lengths;  ///< Every Content-Length header.
  bool is_chunked = false;           ///< Has a Transfer-Encoding, of whatever kind.
  std::string cookie;
  std::string authorization;
  std::string query_token;  ///< Of the address: ?token=...
};

/// Who we are.
struct House {
  std::string token;
  std::string cookie_name;
  /// Names that may stand in Host beside numbers and localhost; lower case.
  std::vector<std::string> names = {};
};

enum class Refusal {
  none,
  method,          ///< 405: neither GET, HEAD nor POST.
  long_path,       ///< 414
  foreign_host,    ///< 421: a name that is not ours.
  foreign_origin,  ///< 403: a page of somebody else asks.
  no_token,        ///< 401
  body_of_get,     ///< 400: a GET with a body.
  no_length,       ///< 411: a POST that does not say how long it is.
  unclear_length,  ///< 400: a length that is no number, or several.
  large_body,      ///< 413
  not_json,        ///< 415
};

Refusal admit(const Visitor& visitor, const House& house);

/// The HTTP status of a refusal.
int status_of(Refusal refusal);
/// A stable name, such as "no_token".
const char* code_of(Refusal refusal);
/// What to do about it, in one line.
const char* words_of(Refusal refusal);

/// Whether both are equal, in a time that does not tell how much of them is.
bool same_secret(std::string_view a, std::string_view b);

/// The value of a cookie; empty where there is none of this name.
std::string_view cookie_value(std::string_view cookies, std::string_view name);

/// Whether a visitor brings the token, by whichever of the three ways.
bool has_token(const Visitor& visitor, const House& house);

/// Whether a Host header, with or without a port, is a number, localhost or one of the names.
bool is_our_host(std::string_view host, const std::vector<std::string>& names);

/// Whether a media type is application/json, whatever parameters follow.
bool is_json(std::string_view content_type);

/// Whether a text may name a client: 1 to 64 letters, digits and hyphens.
bool is_client_name(std::string_view name);

/// 128 bits by the system's generator, in hexadecimal. Throws Error(unavailable) where it gives
/// none.
std::string random_token();

/// Throws Error(bad_argument) for a token that is guessed easily, or that an address cannot hold.
void require_token(std::string_view token);

}  // namespace fathom::serve
