// SPDX-License-Identifier: Apache-2.0
// What an option can be set to, in the words of its help.
#pragma once

#include <span>
#include <string>

namespace fathom::cli {

/// One of the values that an option takes.
struct NamedOption {
  const char* name;
  const char* help;  ///< A few words, or empty.
};

/// "one (its help), two, three", with `before_last` in front of the last one.
std::string listed(std::span<const NamedOption> options, const char* before_last);

}  // namespace fathom::cli
