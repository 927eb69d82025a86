// SPDX-License-Identifier: Apache-2.0
// Texts that others wrote (names of files and devices, units, notes), made harmless to print.
#pragma once

#include <string>
#include <string_view>

namespace fathom {

/// The text as one line that commands no terminal. Control characters, bytes that are no UTF-8, and
/// characters that turn the direction of writing or break the line become \xNN, byte by byte.
std::string printable(std::string_view text);

}  // namespace fathom
