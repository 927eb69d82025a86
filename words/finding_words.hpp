// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hal/finding.hpp"

namespace fathom {

/// What was noticed on opening a rig, in one line.
std::string words_for(const Finding& finding);

}  // namespace fathom
