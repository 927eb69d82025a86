// SPDX-License-Identifier: Apache-2.0
// TOML that somebody else wrote, read within limits.
#pragma once

#include <string>
#include <string_view>

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

namespace fathom {

/// Reads a whole text. where: how messages name it. Throws Error(bad_data), with the line, for what
/// is no TOML or nests too deep for a reader that descends a level for each bracket.
toml::table parse_toml(std::string_view text, const std::string& where);

}  // namespace fathom
