// SPDX-License-Identifier: Apache-2.0
// What the program says of a verdict, with what to try.
#pragma once

#include <string>

#include "focus/verdict.hpp"

namespace fathom::cli {

/// One line without an end: why the verdict is what it is, and the options that may help.
std::string words_for(const Verdict& verdict);

}  // namespace fathom::cli
