// SPDX-License-Identifier: Apache-2.0
// A test: every peer's scores are those of `reference`, and other metrics' those of plain loops, so
// that comparing times is fair.
#include <fmt/format.h>

#include <exception>
#include <string>

#include "bench/agreement.hpp"
#include "bench/contestants.hpp"

namespace fathom::bench {
namespace {

/// Whether the error is small enough; says so in one line.
bool is_good(const char* who, const std::string& metric, double error, double most) {
  const bool good = error <= most;
  fmt::print("{:22} {:22} {:8.1e} of {:.0e}{}\n", who, metric, error, most,
             good ? "" : "  DISAGREES");
  return good;
}

/// Of small windows more than a plan of FFTW takes at once, and some that are left over.
int window_count(int n) { return n <= 16 ? 40 : n <= 128 ? 5 : 1; }

bool agrees(const Peer& peer, int n) {
  const MetricSpec spec = peer.metric(n);
  const auto score = peer_scorer(peer.prepare(n, Planning::quick));
  return is_good(peer.name, spec.text(), largest_error(score, spec, window_count(n)),
                 tolerance(spec));
}

bool agrees(const OtherMetric& metric, int n) {
  const auto score = peer_scorer(metric.prepare(n));
  return is_good(metric.contestant, fmt::format("{}:{}", metric.metric, n),
                 largest_error(score, metric, n, window_count(n)), kOtherTolerance);
}

bool all_agree() {
  bool good = true;
  for (int n = kSmallestWindow; n <= kLargestWindow; n *= 2) {
    for (const Peer& peer : all_peers()) good = agrees(peer, n) && good;
    for (const OtherMetric& metric : other_metrics()) good = agrees(metric, n) && good;
  }
  return good;
}

}  // namespace
}  // namespace fathom::bench

int main() try { return fathom::bench::all_agree() ? 0 : 1; } catch (const std::exception& error) {
  fmt::print(stderr, "bench_peers_agree: {}\n", error.what());
  return 1;
}
