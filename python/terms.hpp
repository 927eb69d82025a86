// SPDX-License-Identifier: Apache-2.0
// What Python's users call what may help: arguments of the package's functions.
#pragma once

#include "words/terms.hpp"

namespace fathom::python {

inline constexpr Terms kTerms = {.average = "average",
                                 .window = "window",
                                 .ends = "from_ and to",
                                 .wider = "from_ and to",
                                 .metric_before = "metric='",
                                 .metric_after = "'",
                                 .settling_check = ""};

}  // namespace fathom::python
