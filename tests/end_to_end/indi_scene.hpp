// SPDX-License-Identifier: Apache-2.0
// The fake INDI server's camera sees the simulated scene through the lens that its focuser moves.
#pragma once

#include <fitsio.h>

#include <string>
#include <tuple>
#include <vector>

#include "tests/unit/hal/aravis/fake_gige.hpp"
#include "tests/unit/hal/indi/fake_server.hpp"

namespace fathom::test {

/// Where the focuser ends that begins at 0.
inline constexpr double kIndiTravel = 1000;

/// lens_steps: of the simulated lens, over that travel; taken: called for every picture. What is passed
/// must outlive the server.
template <class Taken>
void show_scene(FakeServer& server, SimulatedScene& scene, double lens_steps, Taken taken) {
  constexpr long kWidth_px = 256, kHeight_px = 240;
  for (const auto& [property, width, height] :
       {std::tuple{"CCD_INFO", "CCD_MAX_X", "CCD_MAX_Y"}, {"CCD_FRAME", "WIDTH", "HEIGHT"}}) {
    server.set("Cam", property, width, std::to_string(kWidth_px));
    server.set("Cam", property, height, std::to_string(kHeight_px));
  }
  server.paint([&scene, lens_steps, taken](double motor) {
    taken();
    const Painter painter = scene.at(motor / kIndiTravel * lens_steps);
    std::vector<double> pixels;
    for (int y = 0; y < kHeight_px; ++y)
      for (int x = 0; x < kWidth_px; ++x) pixels.push_back(painter(x, y));
    return make_fits(BYTE_IMG, {kWidth_px, kHeight_px}, pixels);
  });
}

}  // namespace fathom::test
