// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/named_options.hpp"

namespace fathom::cli {

std::string listed(std::span<const NamedOption> options, const char* before_last) {
  std::string text;
  for (std::size_t i = 0; i < options.size(); ++i) {
    if (i > 0) text += i + 1 < options.size() ? ", " : before_last;
    text += options[i].name;
    if (*options[i].help != '\0') text += std::string(" (") + options[i].help + ")";
  }
  return text;
}

}  // namespace fathom::cli
