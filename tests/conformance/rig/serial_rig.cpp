// SPDX-License-Identifier: Apache-2.0
#include "serial_rig.hpp"

#include "hal/drivers/serial/serial_lens.hpp"
#include "hal/drivers/serial/settings.hpp"
#include "place_camera.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/hal/serial/simulated_stage.hpp"

namespace fathom::test {

Hardware open_serial_rig(const OpenOptions& options) {
  static const TemporaryFolder folder;
  static const std::unique_ptr<SimulatedStage> stage = make_stage("grbl", 100);
  const RigSettings keys("rail", {{"port", stage->port()},
                                  {"profile", "grbl"},
                                  {"state", (folder / "state.json").string()},
                                  {"lowest", "0"},
                                  {"highest", "100"},
                                  {"step", "1"},
                                  {"backlash", "8"},
                                  {"settle_ms", "2"}});
  serial::Settings settings = serial::Settings::read(keys);
  settings.profile.wait_s = 0;  // a pseudo-terminal resets nobody
  auto lens = std::make_unique<serial::SerialLens>(settings, options.stop_requests);
  stage->motor().set(0);
  lens->declare_at(0);
  return {std::make_unique<PlaceCamera>("camera beside a made-up rail",
                                        [motor = stage->shared_motor()](const Exposure& exposure) {
                                          return motor->mean(exposure.start_ns, exposure.end_ns);
                                        }),
          std::move(lens), nullptr};
}

}  // namespace fathom::test
