// SPDX-License-Identifier: Apache-2.0
// A test: every peer's scores are those of `reference`, so that comparing times is fair.
#include <fmt/format.h>

#include <exception>

#include "bench/agreement.hpp"
#include "bench/contestants.hpp"

namespace fathom::bench {
namespace {

/// Whether the peer agrees; says so in one line.
bool agrees(const Peer& peer, int n) {
  const MetricSpec spec = peer.metric(n);
  const auto prepared = peer.prepare(n, Planning::quick);
  const auto score = [&](const Frame& frame, std::span<const Window> windows,
                         std::span<double> scores) { prepared->score(frame, windows, scores); };
  const double error = largest_error(score, spec, n <= 128 ? 5 : 1);
  const bool good = error <= tolerance(spec);
  fmt::print("{:22} {:20} {:8.1e} of {:.0e}{}\n", peer.name, spec.text(), error, tolerance(spec),
             good ? "" : "  DISAGREES");
  return good;
}

bool all_agree() {
  bool good = true;
  for (const Peer& peer : all_peers()) {
    for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) good = agrees(peer, n) && good;
  }
  return good;
}

}  // namespace
}  // namespace fathom::bench

int main() try { return fathom::bench::all_agree() ? 0 : 1; } catch (const std::exception& error) {
  fmt::print(stderr, "bench_peers_agree: {}\n", error.what());
  return 1;
}
