// SPDX-License-Identifier: Apache-2.0
// What those who are told something call what may help.
#pragma once

#include <string>
#include <string_view>

namespace fathom {

/// Names of what a user may change: the program's options, unless somebody says otherwise.
struct Terms {
  std::string_view average = "--average";                 ///< Frames averaged at a position.
  std::string_view window = "--window";                   ///< Where the window is, and its side.
  std::string_view ends = "--from and --to";              ///< Of what is searched.
  std::string_view wider = "--from, --to or --bracket";   ///< What searches more.
  std::string_view metric_before = "--metric ";           ///< Stands before a metric's text,
  std::string_view metric_after = "";                     ///< and after it.
  std::string_view settling_check = "fathom rigs check";  ///< Measures whether a lens settles.

  std::string metric(std::string_view text) const {
    return std::string(metric_before).append(text).append(metric_after);
  }
};

}  // namespace fathom
