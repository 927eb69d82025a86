// SPDX-License-Identifier: Apache-2.0
// Times one peer at one cell, and prints the lines that bench/gpu/report reads.
#pragma once

#include "callback_plan.cuh"
#include "options.cuh"
#include "work.cuh"

namespace fathom::peer {

/// Between the kernels of one pipeline: launches cost nothing at this size, and two pipelines and
/// cuFFT's own memory fit any card of a data centre.
constexpr std::size_t kMostBetween = std::size_t{2} << 30;

inline void print_line(const std::string& what, const Cell& cell, const std::string& rest) {
  std::printf("{\"what\":\"%s\",\"metric\":\"%s\",\"depth\":%d,\"batch\":%zu,%s}\n", what.c_str(),
              cell.metric.text().c_str(), cell.metric.depth, cell.batch, rest.c_str());
  std::fflush(stdout);  // a run that is cut off has lost nothing
}

inline std::string line_name(const Peer& peer, bool is_streamed) {
  return peer.name + (is_streamed ? "-streamed" : "-resident");
}

inline bench::Times time_one(const Peer& peer, const Pixels& pixels, const Cell& cell,
                             const Tiles& tiles, std::size_t chunk, bool is_streamed,
                             double budget_s) {
  Work work(peer, pixels, cell.metric, tiles, chunk, is_streamed);
  work.step();
  work.step();
  work.land_and_check();
  const bench::Times times = bench::time_steps([&] { work.step(); }, budget_s);
  work.land_and_check();
  return times;
}

/// Large parts keep the card busy, small ones stay in its second-level cache: the faster counts.
inline void measure(const Peer& peer, const Pixels& pixels, const Cell& cell,
                    std::size_t cache_bytes, bool is_streamed, const Options& options,
                    const std::string& device) {
  const Tiles tiles(cell.metric, cell.windows);
  bench::Times best;
  std::size_t best_chunk = 0;
  for (const std::size_t bytes : {kMostBetween, cache_bytes / 2}) {
    const std::size_t chunk = peer.chunk_for(cell.metric, cell.windows, bytes);
    if (chunk == best_chunk) continue;
    const auto times = time_one(peer, pixels, cell, tiles, chunk, is_streamed, options.cell_s);
    if (best_chunk != 0 && best.median_s <= times.median_s) continue;
    best = times;
    best_chunk = chunk;
  }
  const double windows = static_cast<double>(cell.windows), us = 1e6 / windows;
  char rest[512];
  std::snprintf(rest, sizeof rest,
                "\"windows\":%zu,\"us_per_window\":%.9g,\"windows_per_s\":%.9g,\"min\":%.9g,"
                "\"median\":%.9g,\"max\":%.9g,\"repetitions\":%zu,\"chunk\":%zu,\"device\":\"%s\"",
                cell.windows, us * best.median_s, windows / best.median_s, us * best.min_s,
                us * best.median_s, us * best.max_s, best.repetitions, best_chunk, device.c_str());
  print_line(line_name(peer, is_streamed), cell, rest);
}

/// What failed stands in its row.
inline void print_failed(const Peer& peer, const Cell& cell, bool is_streamed, std::string why) {
  const std::string name = line_name(peer, is_streamed);
  std::fprintf(stderr, "cuda_peer: NOT TIMED: %s: %s of %d bits, batch %zu: %s\n", name.c_str(),
               cell.metric.text().c_str(), cell.metric.depth, cell.batch, why.c_str());
  std::replace(why.begin(), why.end(), '"', '\'');
  print_line("failed", cell, "\"doing\":\"" + name + "\",\"why\":\"" + why + "\"");
}

/// Whether both ways were measured, or cuFFT has no such plan.
inline bool measure_both(const Peer& peer, const Pixels& pixels, const Cell& cell,
                         std::size_t cache_bytes, const Options& options,
                         const std::string& device) {
  for (const bool is_streamed : {false, true}) {
    try {
      measure(peer, pixels, cell, cache_bytes, is_streamed, options, device);
    } catch (const PlanRefused& refusal) {
      print_failed(peer, cell, is_streamed, refusal.what());
      cudaGetLastError();
    } catch (const std::exception& error) {
      print_failed(peer, cell, is_streamed, error.what());
      // After an error in a kernel nothing on the device works any more.
      PEER_CHECK(cudaDeviceSynchronize());
      cudaGetLastError();  // one that was reported, such as too little memory, is done with
      return false;
    }
  }
  return true;
}

}  // namespace fathom::peer
