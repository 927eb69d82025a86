// SPDX-License-Identifier: Apache-2.0
// The report: what was done, what came out, what it means.
#pragma once

#include <string>

#include "tools/fathom/reproduce/claims.hpp"
#include "tools/fathom/reproduce/figures.hpp"
#include "tools/fathom/thesis_table.hpp"

namespace fathom::reproduce {

/// What differs from run to run and from machine to machine. It is in the section "speed" only.
struct ThisRun {
  cli::ThesisTimes times;
  std::string program;  ///< Name and version.
  std::string machine;
  std::string date;
};

Document build_report(const Results& results, const std::vector<Claim>& claims,
                      const ThisRun& this_run, const Artist& artist);

/// Every number as JSON.
std::string results_json(const Results& results, const std::vector<Claim>& claims,
                         const ThisRun& this_run);

// Its sections, in their order; a file holds those of one subject.
Section claims_section(const Results& results, const std::vector<Claim>& claims,
                       const Artist& artist);
Section rig_section(const Results& results);
Section why_section(const Results& results, const Artist& artist);
Section curves_section(const Results& results, const Artist& artist);
Section far_section(const Results& results, const Artist& artist);
Section repeatability_section(const Results& results, const Artist& artist);
Section calibration_section(const Results& results, const Artist& artist);
Section tables_section(const Results& results, const Artist& artist);
Section seedling_section(const Results& results, const Artist& artist);
Section orange_section(const Results& results, const Artist& artist);
Section searches_section(const Results& results, const Artist& artist);
Section own_way_section(const Results& results, const Artist& artist);
Section ways_section(const Results& results, const Artist& artist);
Section limits_section();
Section speed_section(const ThisRun& this_run);

}  // namespace fathom::reproduce
