// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/warning_notes.hpp"

#include "tools/fathom/console.hpp"
#include "words/warning_words.hpp"

namespace fathom::cli {

void WarningNotes::warned(const Warning& warning) {
  for (const std::string& line : lines_of(warning)) note(line);
}

}  // namespace fathom::cli
