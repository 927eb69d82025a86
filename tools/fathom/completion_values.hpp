// SPDX-License-Identifier: Apache-2.0
// The values that a shell can offer for an option or an argument.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/fathom/manual.hpp"

namespace fathom::cli {

/// What may be written behind an option.
struct OfferedValues {
  std::vector<std::string> words;
  bool has_files = true;  ///< Whether files and folders are offered too.
};

/// Those of an option's entry in the table: of options that name something of this build, of
/// options with a list of numbers; else files.
OfferedValues offered_values(const OptionEntry& option);

/// "-o,--output" taken apart.
std::vector<std::string> names_of(const OptionEntry& option);

}  // namespace fathom::cli
