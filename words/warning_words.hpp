// SPDX-License-Identifier: Apache-2.0
// A session's warnings in words.
#pragma once

#include <string>
#include <vector>

#include "session/warning.hpp"
#include "words/terms.hpp"

namespace fathom {

/// What a warning says: some lines, without line ends.
std::vector<std::string> lines_of(const Warning& warning, const Terms& terms = {});

/// "0.081 px a step".
std::string blur_words(double px_per_unit, const std::string& unit);

}  // namespace fathom
