// SPDX-License-Identifier: Apache-2.0
// Past a focus that the pictures of another search foretell.
#pragma once

#include "search.hpp"

namespace fathom {

struct FocusLimits;

/// Whether the spectra of all pictures so far are sure of a focus near this place, and still are once
/// the lens has gone past it. limits.blur must be there.
bool pass_by_spectra(SearchTrace& trace, const FocusLimits& limits, double place);

}  // namespace fathom
