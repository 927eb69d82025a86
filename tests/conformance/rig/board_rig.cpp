// SPDX-License-Identifier: Apache-2.0
#include "board_rig.hpp"

#include "place_camera.hpp"
#include "tests/unit/hal/stepper/fake_board.hpp"

namespace fathom::test {
Hardware open_board_rig(const OpenOptions& options) {
  static const TemporaryFolder folder;
  const RigSettings keys("board", {{"port", "/dev/none"},
                                   {"state", (folder / "state.json").string()},
                                   {"highest", "100"},
                                   {"limit", "500"},
                                   {"rate", "500"},
                                   {"home_rate", "500"},
                                   {"backlash", "8"},
                                   {"settle_ms", "2"},
                                   {"home_by", "stop"},
                                   {"home_position", "-6"}});  // so that the lens's 0 is its own
  const auto board = std::make_shared<FakeBoard>(stepper::monotonic_time());
  board->play = 6;
  board->top = 150;
  auto lens = std::make_unique<stepper::StepperLens>(
      stepper::Settings::read(keys), std::make_unique<FakeLines>(board), stepper::monotonic_time(),
      options.stop_requests);
  lens->declare_at(0);
  return {std::make_unique<PlaceCamera>(
              "camera beside a made-up driver board",
              [board](const Exposure& exposure) { return board->mean_lens(exposure); }),
          std::move(lens), nullptr};
}

}  // namespace fathom::test
