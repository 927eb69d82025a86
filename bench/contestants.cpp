// SPDX-License-Identifier: Apache-2.0
#include "bench/contestants.hpp"

#include <string_view>

#include "backends/backends.hpp"

namespace fathom::bench {
namespace {

/// A scorer that keeps the device alive as long as its plan.
Scorer device_scorer(const Backend& backend, std::size_t index, const DeviceOptions& options,
                     const MetricSpec& spec, std::size_t capacity) {
  std::shared_ptr<Device> device = backend.open(index, options);
  std::shared_ptr<Plan> plan = device->plan(spec, capacity);
  return [device, plan](const Frame& frame, std::span<const Window> windows,
                        std::span<double> scores) { plan->score(frame, windows, scores); };
}

Contestant device_contestant(const Backend& backend, std::size_t index, const DeviceInfo& info,
                             const DeviceOptions& options) {
  Contestant contestant;
  contestant.name = backend.name();
  if (index > 0) contestant.name += ":" + std::to_string(index);
  contestant.transforms = {Transform::fft, Transform::walsh_sequency, Transform::dct};
  contestant.takes_16_bits = true;
  contestant.measures_rings = true;
  contestant.all_threads = options.threads != 1;
  contestant.works_elsewhere = contestant.all_threads || info.kind != DeviceKind::cpu;
  contestant.prepare = [&backend, index, options](const MetricSpec& spec, std::size_t capacity) {
    return device_scorer(backend, index, options, spec, capacity);
  };
  return contestant;
}

void add_devices(const Backend& backend, std::vector<Contestant>& contestants) {
  // The direct sums take a millisecond at N = 64, and have one thread only.
  const bool is_oracle = std::string_view(backend.name()) == "reference";
  const auto infos = backend.devices();
  for (std::size_t index = 0; index < infos.size(); ++index) {
    contestants.push_back(device_contestant(backend, index, infos[index], {.threads = 1}));
    if (is_oracle) {
      contestants.back().largest_n = 16;
    } else if (infos[index].kind == DeviceKind::cpu) {
      contestants.push_back(device_contestant(backend, index, infos[index], {.threads = 0}));
    }
  }
}

Contestant peer_contestant(const Peer& peer, Planning planning) {
  Contestant contestant;
  contestant.name = peer.name;
  contestant.transforms = {peer.transform};
  contestant.works_elsewhere = peer.on_device;
  contestant.prepare = [&peer, planning](const MetricSpec& spec, std::size_t) {
    return peer_scorer(peer.prepare(spec.n, planning));
  };
  return contestant;
}

}  // namespace

Scorer peer_scorer(const std::shared_ptr<PreparedPeer>& peer) {
  return [peer](const Frame& frame, std::span<const Window> windows, std::span<double> scores) {
    peer->score(frame, windows, scores);
  };
}

std::vector<Contestant> all_contestants(Planning planning) {
  std::vector<Contestant> contestants;
  for (const Backend* backend : all_backends()) add_devices(*backend, contestants);
  for (const Peer& peer : all_peers()) contestants.push_back(peer_contestant(peer, planning));
  return contestants;
}

}  // namespace fathom::bench
