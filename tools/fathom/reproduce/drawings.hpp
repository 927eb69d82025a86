// SPDX-License-Identifier: Apache-2.0
// The thesis' schematic figures, drawn anew: the files of docs/figures/.
#pragma once

#include "tools/fathom/reproduce/document.hpp"

namespace fathom::reproduce {

/// Figures 1 and 2: the thin lens and its depth of field.
Figure lens_drawings();
/// Figures 6 and 7: the moment of inertia of a spectrum.
Figure moment_drawings();
/// Figure 9: the intervals of the search.
Figure search_drawing();

}  // namespace fathom::reproduce
