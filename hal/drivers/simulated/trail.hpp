// SPDX-License-Identifier: Apache-2.0
// Where the simulated lens truly stood while it was watched.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/frame.hpp"

namespace fathom::simulated {

/// A place that the lens had during a part of an exposure.
struct Stay {
  int lens = 0;      ///< Where, in steps.
  double share = 1;  ///< Of the exposure.
};

class Trail {
 public:
  /// The lens stands at `lens` from this time on; times never go back.
  void add(std::int64_t since_ns, int lens);
  /// Forgets what was over before this time.
  void forget_before(std::int64_t time_ns);
  void clear() { places_.clear(); }

  /// Whether a step falls into an exposure or after it.
  bool covers(const Exposure& exposure) const;

  /// The places of an exposure of some length, each once; only where covers() it.
  std::vector<Stay> stays(const Exposure& exposure) const;

 private:
  struct Place {
    std::int64_t since_ns;
    int lens;
  };
  std::vector<Place> places_;
};

}  // namespace fathom::simulated
