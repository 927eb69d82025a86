// SPDX-License-Identifier: Apache-2.0
// A blur model in the files that keep one.
#pragma once

#include "engine/json.hpp"
#include "focus/blur.hpp"

namespace fathom {

nlohmann::ordered_json to_json(const BlurModel& blur);

/// Throws as require_valid, parse_blur_shape and nlohmann::json.
BlurModel blur_from(const nlohmann::ordered_json& json);

}  // namespace fathom
