// SPDX-License-Identifier: Apache-2.0
#include "hal/camera_settings.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"

namespace fathom {

bool have_meaning(const CameraSettings& wished) {
  return wished.width_px > 0 && wished.height_px > 0 && wished.exposure_ms >= 0;
}

Validity adjust(CameraSettings& wished, const CameraSettings& possible) {
  if (wished == possible) return Validity::valid;
  wished = possible;
  return Validity::adjusted;
}

void require_valid(const Camera& camera, const CameraSettings& settings) {
  CameraSettings checked = settings;
  if (camera.validate(checked) == Validity::valid) return;
  throw Error(ErrorCode::unsupported,
              fmt::format("{} cannot give {} x {} px of {} bit at {} ms", camera.description(),
                          settings.width_px, settings.height_px, static_cast<int>(settings.depth),
                          settings.exposure_ms));
}

}  // namespace fathom
