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
}

void RunKeeper::evaluated(const Measurement& measurement) {
  file.runs.back().measurements.push_back(measurement);
}

void RunKeeper::found(const Focus& focus) { file.runs.back().focus = focus; }

}  // namespace fathom
