// SPDX-License-Identifier: Apache-2.0
#include "session/one_number.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {

void require_one_number(const MetricSpec& spec) {
  if (spec.outputs() == 1) return;
  throw Error(ErrorCode::bad_argument,
              fmt::format("metric {} gives {} numbers for each window, and a focus is looked for "
                          "by one",
                          spec.text(), spec.outputs()));
}

}  // namespace fathom
