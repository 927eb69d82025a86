// SPDX-License-Identifier: Apache-2.0
// The surfaces that a rig sees: a stack is taken, mapped and taken apart.
#pragma once

#include <optional>
#include <string>

#include "mapping/survey.hpp"
#include "tools/fathom/depth/taking.hpp"

namespace fathom::cli {

/// Takes what `taking` has and finds its surfaces. label: of the progress bar; blur: of the lens,
/// where the lens does not say it; observer: of a live sweep. Throws as Taking::take and
/// DepthMaker::finish.
mapping::Survey survey(Taking& taking, const std::string& label, const OpenDevice& open,
                       const std::optional<BlurModel>& blur, Observer& observer);

}  // namespace fathom::cli
