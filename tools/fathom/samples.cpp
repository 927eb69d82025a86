// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace fathom::cli {

WindowTime summary_of(std::span<const Sample> samples) {
  std::vector<double> times_us;
  double wall_s = 0, processor_s = 0;
  for (const Sample& sample : samples) {
    times_us.push_back(sample.window_us);
    wall_s += sample.wall_s;
    processor_s += sample.processor_s;
  }
  std::sort(times_us.begin(), times_us.end());
  const std::size_t last = times_us.size() - 1;
  return {.median_us = times_us[times_us.size() / 2],
          .min_us = times_us.front(),
          .max_us = times_us.back(),
          .lower_quartile_us = times_us[last / 4],
          .upper_quartile_us = times_us[last - last / 4],
          .processor_share = wall_s > 0 ? std::min(1.0, processor_s / wall_s) : 1.0};
}

double gigabytes_per_s(int n, int bytes_per_pixel, double window_us) {
  return 1e-3 * n * n * bytes_per_pixel / window_us;
}

bool is_busy(double processor_share) { return processor_share < 0.95; }

std::string busy_text(double processor_share) {
  return fmt::format(
      "the machine is busy with other work: in one row a thread had its processor for {:.0f} % of "
      "the time; times are too long, so try again when it is quiet",
      100 * processor_share);
}

}  // namespace fathom::cli
