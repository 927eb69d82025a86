// SPDX-License-Identifier: Apache-2.0
// Other metrics than Fathom's, which many users run today. They transform nothing: not the same
// work, so not peers, but what a user would replace.
#pragma once

#include <memory>
#include <span>

#include "bench/peers/peer.hpp"

namespace fathom::bench {

struct OtherMetric {
  const char* contestant;  ///< "peer-opencv-laplacian".
  const char* metric;      ///< "laplacian-variance".
  std::unique_ptr<PreparedPeer> (*prepare)(int n);
  /// What it must come to, by plain loops.
  double (*plain)(const Frame& frame, const Window& window);
};

/// Those that this build has.
std::span<const OtherMetric> other_metrics();

}  // namespace fathom::bench
