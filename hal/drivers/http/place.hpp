// SPDX-License-Identifier: Apache-2.0
// Where a service is, as a rig text says it.
#pragma once

#include <string>
#include <string_view>

#include "hal/socket.hpp"

namespace fathom::http {

inline constexpr const char* kUsualPort = "8470";

struct Place {
  Address address;
  std::string token;  ///< Empty where the text has none.
};

/// Reads "http://HOST:PORT/?token=TOKEN", with or without "http:", port, slash and token: what
/// fathom serve prints, and what is left of it behind the name of the driver. Throws
/// Error(bad_argument).
Place parse_place(std::string_view text);

}  // namespace fathom::http
