// SPDX-License-Identifier: Apache-2.0
// Everything that can be timed: the devices of every backend, and the peers.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/peers/peer.hpp"
#include "engine/frame.hpp"
#include "engine/metric.hpp"
#include "engine/window.hpp"

namespace fathom::bench {

/// scores become the numbers of the windows, as Plan::score gives them.
using Scorer = std::function<void(const Frame&, std::span<const Window>, std::span<double>)>;

/// A peer's, which lives as long as the scorer.
Scorer peer_scorer(const std::shared_ptr<PreparedPeer>& peer);

/// Something that scores, ready for the clock only after prepare().
struct Contestant {
  std::string name;                   ///< "cpu", "cpu:1", "peer-fftw".
  std::vector<Transform> transforms;  ///< What it is timed with.
  int largest_n = kLargestWindow;     ///< Above this it would take too long.
  bool all_threads = false;           ///< Uses every processor; else one, or it is a GPU.
  bool takes_16_bits = false;         ///< Else 8-bit frames only.
  bool measures_rings = false;        ///< Is timed with them too.
  bool works_elsewhere = false;  ///< Off the calling thread, whose processor time says nothing.
  /// Up to `capacity` windows a call. Throws Error, also for a metric that it does not take.
  std::function<Scorer(const MetricSpec& spec, std::size_t capacity)> prepare;
};

/// Every device of every backend on one thread, again on all, and the peers on one.
std::vector<Contestant> all_contestants(Planning planning);

}  // namespace fathom::bench
