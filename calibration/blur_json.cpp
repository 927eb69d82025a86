// SPDX-License-Identifier: Apache-2.0
#include "calibration/blur_json.hpp"

#include <string>

namespace fathom {

using Json = nlohmann::ordered_json;

Json to_json(const BlurModel& blur) {
  return {{"px_per_unit", blur.px_per_unit},
          {"rest_px", blur.rest_px},
          {"uncertainty", blur.uncertainty},
          {"shape", to_string(blur.shape)}};
}

BlurModel blur_from(const Json& json) {
  const BlurModel blur{.px_per_unit = json.at("px_per_unit"),
                       .rest_px = json.at("rest_px"),
                       .uncertainty = json.at("uncertainty"),
                       .shape = parse_blur_shape(json.at("shape").get<std::string>())};
  require_valid(blur);
  return blur;
}

}  // namespace fathom
