// SPDX-License-Identifier: Apache-2.0
// All experiments together.
#pragma once

#include <string>

#include "tools/fathom/reproduce/curves.hpp"
#include "tools/fathom/reproduce/looks.hpp"
#include "tools/fathom/reproduce/repeatability.hpp"
#include "tools/fathom/reproduce/tables.hpp"
#include "tools/fathom/reproduce/trials.hpp"
#include "tools/fathom/reproduce/ways.hpp"

namespace fathom::reproduce {

struct Results {
  Effort effort;
  Looks looks;
  Curves curves;
  Calibrations calibrations;
  std::vector<TableSet> tables;
  Repeatability repeatability;
  OwnWay own;
  Orange orange;
  Searches searches;
  Ways ways;

  Results() = default;
  Results(const Results&) = delete;  // Tasks hold on to its parts.
  Results& operator=(const Results&) = delete;
};

/// Measures everything. on_done: see run_all(). Throws Error(cancelled) when should_stop says so.
void run_experiments(Results& results, const ShouldStop& should_stop,
                     const std::function<void(std::size_t done, std::size_t all)>& on_done);

}  // namespace fathom::reproduce
