// SPDX-License-Identifier: Apache-2.0
// A session's warnings in words.
#pragma once

#include <string>
#include <vector>

#include "session/observer.hpp"

namespace fathom::cli {

/// What a warning says to somebody at a terminal: some lines, without line ends.
std::vector<std::string> lines_of(const Warning& warning);

/// Says every warning on stderr.
class WarningNotes final : public Observer {
 public:
  void warned(const Warning& warning) override;
};

}  // namespace fathom::cli
