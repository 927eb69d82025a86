// SPDX-License-Identifier: Apache-2.0
// --window auto and --window nearest: a few frames over the travel tell which surfaces there are,
// and one of them is measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.hpp"
#include "session/rig.hpp"
#include "tools/fathom/arguments.hpp"

namespace fathom::cli {

/// What is added to the help of --window where it takes these words.
inline constexpr const char* kAimHelp =
    "; or auto (where most texture of one depth is) or nearest (on the nearest surface): a coarse "
    "sweep finds it";

/// What is measured, and where it is looked for.
struct AimRequest {
  std::string verb;
  const RigArguments& rig;
  std::optional<double> from = {}, to = {};  ///< Of the look round.
  std::optional<BlurModel> blur = {};        ///< Of the lens, where somebody says it.
  const Calibration* calibration = nullptr;  ///< Says which way is near; may be null.
  /// Members of the verb's JSON line that are null where nothing could be measured.
  std::vector<const char*> unmeasured = {"position", "sigma"};
};

/// Whether the user leaves the window to Fathom.
bool chooses_window(const RigArguments& rig);

/// The rig, which is opened once, with its window. Where the user leaves that to Fathom, a look round
/// chooses it, which is said with the reason. Nothing where there is none: then that was told as a
/// search tells that there is no focus. A run keeps what was measured where that is so or the look
/// fails. Throws Error(cancelled) after a stop, and as Taking and Rig.
std::optional<Rig> aimed_rig(const AimRequest& request);

}  // namespace fathom::cli
