// SPDX-License-Identifier: Apache-2.0
// What the thesis claims, and what came out here.
#pragma once

#include <string>
#include <vector>

#include "tools/fathom/reproduce/document.hpp"
#include "tools/fathom/reproduce/results.hpp"

namespace fathom::reproduce {

struct Claim {
  std::string id;  ///< For JSON.
  std::string claim;
  std::string where;   ///< Page, figure or table of the thesis.
  std::string thesis;  ///< Its number.
  std::string ours;
  Mark outcome = Mark::none;
  std::string section;  ///< Of the report, where the evidence is.
};

/// "holds", "partly", "does not hold".
const char* to_string(Mark mark);

inline Mark holds_if(bool is_true, Mark otherwise = Mark::fails) {
  return is_true ? Mark::holds : otherwise;
}

/// In the order of the report. Each outcome is decided by a rule on the numbers.
std::vector<Claim> claims_of(const Results& results);

// Parts of it, a file each.
void add_claims_on_curves(const Results& results, std::vector<Claim>& claims);
void add_claims_on_ranging(const Results& results, std::vector<Claim>& claims);
void add_claims_on_limits(const Results& results, std::vector<Claim>& claims);

/// 0.0123 as "1.23 %".
std::string percent(double part, int digits = 2);
/// "+-1.23 %"
std::string plus_minus(double part, int digits = 2);

}  // namespace fathom::reproduce
