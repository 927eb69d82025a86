// SPDX-License-Identifier: Apache-2.0
// What a verdict says in words, with what to try.
#pragma once

#include <string>

#include "focus/verdict.hpp"
#include "words/terms.hpp"

namespace fathom {

/// One line without an end: why the verdict is what it is, and what may help.
std::string words_for(const Verdict& verdict, const Terms& terms = {});

}  // namespace fathom
