// SPDX-License-Identifier: Apache-2.0
#include "session/run.hpp"

namespace fathom {

std::vector<Evaluation> Run::evaluations() const {
  std::vector<Evaluation> evaluations;
  for (const Measurement& m : measurements) {
    evaluations.push_back({static_cast<int>(evaluations.size()) + 1, m.position, m.score});
  }
  return evaluations;
}

TimeSpent time_spent(std::span<const Measurement> measurements) {
  TimeSpent spent;
  for (const Measurement& m : measurements) {
    spent.moving += 1e-9 * static_cast<double>(m.stopped_ns - m.started_ns);
    spent.settling += 1e-9 * static_cast<double>(m.settled_ns - m.stopped_ns);
    spent.exposing += 1e-9 * static_cast<double>(m.exposure.end_ns - m.settled_ns);
    spent.computing += 1e-9 * static_cast<double>(m.compute_ns);
  }
  return spent;
}

}  // namespace fathom
