// SPDX-License-Identifier: Apache-2.0
// A rig whose pictures are wanted, and not the score of a window.
#pragma once

#include <string>

#include "session/rig.hpp"

namespace fathom::cli {

/// Opens what --rig names. Pictures of any size will do: of small ones the window is small. average:
/// as --average takes it. Throws as Rig, and as checked_average.
Rig open_picture_rig(const std::string& rig, int average);

}  // namespace fathom::cli
