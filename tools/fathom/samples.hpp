// SPDX-License-Identifier: Apache-2.0
// What repeated timings of the same work come to.
#pragma once

#include <span>
#include <string>

namespace fathom::cli {

/// One timing of the same calls.
struct Sample {
  double window_us = 0;    ///< Wall-clock time for one window.
  double wall_s = 0;       ///< Of all the calls.
  double processor_s = 0;  ///< What the calling thread computed of that.
};

/// Wall-clock time for one window over repeated timings, us.
struct WindowTime {
  double median_us = 0;
  double min_us = 0;
  double max_us = 0;
  double lower_quartile_us = 0;
  double upper_quartile_us = 0;
  /// Processor time of the calling thread over wall-clock time, of all timings together; at most 1.
  double processor_share = 1;
};

/// Of one timing or more. Quartiles lie on timings: no value is made up between two.
WindowTime summary_of(std::span<const Sample> samples);

/// Pixels read for windows of n x n, 10^9 bytes a second.
double gigabytes_per_s(int n, int bytes_per_pixel, double window_us);

/// Whether a thread that never waits had to share its processor: it computed for less than 0.95 of
/// the time.
bool is_busy(double processor_share);

/// What the user is told of such a share.
std::string busy_text(double processor_share);

}  // namespace fathom::cli
