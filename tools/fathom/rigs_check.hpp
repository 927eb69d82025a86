// SPDX-License-Identifier: Apache-2.0
// fathom rigs check: opens a rig, grabs, moves, measures settling and backlash, and suggests what
// its file should say.
#pragma once

#include <string>

#include "tools/fathom/arguments.hpp"

namespace fathom::cli {

struct CheckArguments {
  std::string rig;
  MetricArguments metric;
  bool json = false;
};

/// Returns the exit status: kNoFocus where there was no focus to measure settling and backlash by.
/// Leaves the lens where it was.
int check_rig(const CheckArguments& arguments);

}  // namespace fathom::cli
