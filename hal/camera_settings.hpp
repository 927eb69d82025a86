// SPDX-License-Identifier: Apache-2.0
// What every camera does alike with wished settings.
#pragma once

#include "camera.hpp"

namespace fathom {

/// Whether anything is wished for: sides, and an exposure or none. NaN is none of both.
bool have_meaning(const CameraSettings& wished);

/// Camera::validate() of a wish that has a meaning, where `possible` is the nearest to it.
Validity adjust(CameraSettings& wished, const CameraSettings& possible);

/// Throws Error(unsupported) unless the camera calls them valid.
void require_valid(const Camera& camera, const CameraSettings& settings);

}  // namespace fathom
