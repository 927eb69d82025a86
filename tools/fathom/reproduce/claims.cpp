// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/reproduce/claims.hpp"

#include <fmt/format.h>

namespace fathom::reproduce {

const char* to_string(Mark mark) {
  switch (mark) {
    case Mark::none:
      return "";
    case Mark::holds:
      return "holds";
    case Mark::partly:
      return "partly";
    case Mark::fails:
      return "does not hold";
  }
  return "";
}

std::string percent(double part, int digits) {
  return fmt::format("{:.{}f} %", 100 * part, digits);
}

std::string plus_minus(double part, int digits) { return "\u00B1" + percent(part, digits); }

std::vector<Claim> claims_of(const Results& results) {
  std::vector<Claim> claims;
  add_claims_on_curves(results, claims);
  add_claims_on_ranging(results, claims);
  add_claims_on_limits(results, claims);
  return claims;
}

}  // namespace fathom::reproduce
