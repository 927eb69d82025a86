// SPDX-License-Identifier: Apache-2.0
// A session's warnings at a terminal.
#pragma once

#include "session/observer.hpp"

namespace fathom::cli {

/// Says every warning on stderr.
class WarningNotes final : public Observer {
 public:
  void warned(const Warning& warning) override;
};

}  // namespace fathom::cli
