// SPDX-License-Identifier: Apache-2.0
// What shells offer behind "fathom ": verbs, options, and the values that are known.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "tools/fathom/manual.hpp"

namespace fathom::cli {

/// One shell and the script that it loads.
struct Completion {
  const char* shell;  ///< "bash"
  const char* file;   ///< Where it is looked for, below share/ of the prefix.
  std::string (*script)(const VerbEntry& program);
};

/// bash, zsh and fish.
std::span<const Completion> completions();

}  // namespace fathom::cli
