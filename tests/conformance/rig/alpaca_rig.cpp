// SPDX-License-Identifier: Apache-2.0
#include "alpaca_rig.hpp"

#include <cmath>

#include "tests/unit/hal/alpaca/fake_server.hpp"

namespace fathom::test {

Hardware open_alpaca_rig(const OpenOptions& options) {
  static const FakeAlpaca server(
      {.steps_per_s = 50'000, .longest_s = 1},
      [](int x, int y, double step) { return x + y + 20 * static_cast<int>(std::lround(step)); });
  return open_hardware(server.rig(",exposure_ms=2,backlash=8,settle_ms=1"), options);
}

}  // namespace fathom::test
