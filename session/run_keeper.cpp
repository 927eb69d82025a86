// SPDX-License-Identifier: Apache-2.0
#include "session/run_keeper.hpp"

namespace fathom {

RunSetup setup_of(Rig& rig) {
  return {.verb = {},
          .command = {},
          .created = {},
          .rig = rig.options().rig,
          .camera = rig.camera().description(),
          .lens = rig.lens().info(),
          .metric = rig.spec(),
          .window = rig.window(),
          .backend = rig.selection().backend,
          .backend_reason = rig.selection().reason,
          .average = rig.options().shot.average};
}

void RunKeeper::began(const Run& run, std::size_t) {
  file.runs.push_back(run);
  file.runs.back().target_mm = target_mm_;
  sharpest_.begin();
}

void RunKeeper::frame(const Frame& frame, const Arrival&, std::span<const double> scores) {
  sharpest_.see(frame, scores[0]);
}

void RunKeeper::evaluated(const Measurement& measurement) {
  file.runs.back().measurements.push_back(measurement);
  if (!measurement.on_the_way) sharpest_.keep();
}

void RunKeeper::found(const Focus& focus) {
  Run& run = file.runs.back();
  run.focus = focus;
  run.lost_part = focus.lost_part;
  run.resemblance = focus.resemblance;
  run.first_look = focus.first_look;
  run.spectrum = sharpest_.spectrum();
}

}  // namespace fathom
