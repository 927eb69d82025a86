// SPDX-License-Identifier: Apache-2.0
// What fathom range is told.
#pragma once

#include <optional>
#include <string>

#include "tools/fathom/arguments.hpp"
#include "tools/fathom/range_all.hpp"

namespace fathom::cli {

struct RangeArguments {
  RigArguments rig;
  SearchArguments search;
  std::string calibration;
  std::string plot;
  int repeat = 1;
  std::optional<int> count;  ///< Of distances that --continuous gives; without it there is no end.
  bool continuous = false;
  bool extrapolate = false;
  bool all = false;
  std::optional<double> step;  ///< Of the sweep of --all.
  std::string csv;             ///< Of --all.

  void add_to(Verb& verb);
  /// Throws Error(bad_argument) for options that do not go together.
  void require_sensible() const;
  RangeAllRequest request_for_all() const;
};

}  // namespace fathom::cli
