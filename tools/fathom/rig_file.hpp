// SPDX-License-Identifier: Apache-2.0
// A rig, however it was named, as a rig file.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "session/check.hpp"

namespace fathom::cli {

/// TOML that opens the same rig, line by line, with these settings of the lens in place of its own.
/// Throws as parse_rig().
std::string rig_file_text(std::string_view rig, const std::optional<LensSettings>& lens);

}  // namespace fathom::cli
