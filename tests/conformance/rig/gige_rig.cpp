// SPDX-License-Identifier: Apache-2.0
#include "gige_rig.hpp"

#include "tests/unit/hal/aravis/fake_gige.hpp"

namespace fathom::test {

Hardware open_gige_rig(const OpenOptions& options) {
  static const std::unique_ptr<FakeGige> fake = [] {
    auto camera = std::make_unique<FakeGige>();
    camera->paint([self = camera.get()] {
      const int lens = self->lens_position();
      return [lens](int x, int) { return static_cast<std::uint8_t>(lens / 256 + x + lens); };
    });
    return camera;
  }();
  return open_hardware("aravis:127.0.0.1,width=64,height=48,lens=FocusPos,backlash=8,settle_ms=2",
                       options);
}

}  // namespace fathom::test
