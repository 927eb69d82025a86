// SPDX-License-Identifier: Apache-2.0
// What several verbs have in common, told once: `fathom help TOPIC`.
#pragma once

#include <span>
#include <string>

namespace fathom::cli {

struct Topic {
  const char* name;
  const char* help;  ///< A few words for the list of topics.
  /// What there is to say, in lines of at most kHelpColumns.
  std::string (*text)();
};

/// All of them.
std::span<const Topic> topics();

}  // namespace fathom::cli
