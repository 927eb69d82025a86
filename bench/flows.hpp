// SPDX-License-Identifier: Apache-2.0
// What users wait for besides a batch's scores: the first score, one score, a stream of frames, a
// search; and how time grows. Registers benchmarks with these names:
//
//   latency/CONTESTANT/METRIC/warm      one window a call of a plan that has scored before
//   latency/CONTESTANT/METRIC/cold      a plan made, one window scored, on a device that is open
//   start/CONTESTANT/METRIC             the program `fathom score` from its start to its end
//   stream/CONTESTANT/METRIC/batch:N    a fresh frame a batch, two batches in flight; .../one: one
//   search/CONTESTANT/METRIC            a whole focus search, pictures taken beforehand
//   growth/CONTESTANT/METRIC/windows:N  and .../frame:WIDTH, .../threads:N
#pragma once

#include <string>

namespace fathom::bench {

/// program: `fathom`, for start; such benchmarks are left out, with a note, where it is not there.
void add_flows(const std::string& program);

}  // namespace fathom::bench
