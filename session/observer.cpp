// SPDX-License-Identifier: Apache-2.0
#include "session/observer.hpp"

namespace fathom {

void Observers::began(const Run& run, std::size_t positions) {
  for (Observer* const each : observers_) each->began(run, positions);
}

void Observers::frame(const Frame& frame, const Arrival& arrival, std::span<const double> scores) {
  for (Observer* const each : observers_) each->frame(frame, arrival, scores);
}

void Observers::evaluated(const Measurement& measurement) {
  for (Observer* const each : observers_) each->evaluated(measurement);
}

void Observers::found(const Focus& focus) {
  for (Observer* const each : observers_) each->found(focus);
}

void Observers::warned(const Warning& warning) {
  for (Observer* const each : observers_) each->warned(warning);
}

}  // namespace fathom
