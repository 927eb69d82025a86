// SPDX-License-Identifier: Apache-2.0
#include "session/settling.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr double kSigmas = 5;  // of a sigma that six differences tell

double mean_of(std::span<const AfterMove> frames) {
  const auto add = [](double sum, const AfterMove& frame) { return sum + frame.score; };
  return std::accumulate(frames.begin(), frames.end(), 0.0, add) /
         static_cast<double>(frames.size());
}

/// Of the noise alone: from the differences of neighbours, which a slow drift hardly changes.
double sigma_of(std::span<const AfterMove> frames) {
  double squares = 0;
  for (std::size_t i = 1; i < frames.size(); ++i)
    squares += std::pow(frames[i].score - frames[i - 1].score, 2);
  return std::sqrt(squares / static_cast<double>(2 * (frames.size() - 1)));
}

/// A lens that is still on its way drifts: the means of two halves differ by more than noise, and
/// by more than a lamp does.
bool drifts(std::span<const AfterMove> frames, double sigma, double tolerance) {
  const std::size_t half = frames.size() / 2;
  const double drift = std::abs(mean_of(frames.first(half)) - mean_of(frames.last(half)));
  return drift >
         std::max(kSigmas * sigma * std::sqrt(2.0 / static_cast<double>(half)), 0.3 * tolerance);
}

/// The frame after the last one that is off. One that is off alone, after several that were not, is
/// noise: a lens that moves is seen moving by more than one frame, or by the first ones.
std::size_t first_after_last_run(const std::vector<bool>& is_off) {
  constexpr std::size_t kAlone = 3;
  std::size_t last_off = 0, first_at_rest = 0;
  for (std::size_t i = 0; i < is_off.size(); ++i) {
    if (!is_off[i]) continue;
    if (i < kAlone || (last_off > 0 && i + 1 - last_off <= kAlone)) first_at_rest = i + 1;
    last_off = i + 1;
  }
  return first_at_rest;
}

}  // namespace

Settling judge_settling(std::vector<AfterMove> frames) {
  Settling settling;
  settling.frames = std::move(frames);
  const std::span<const AfterMove> all(settling.frames);
  if (all.size() < kFewestFrames) return settling;
  settling.interval_ms =
      (all.back().since_ms - all.front().since_ms) / static_cast<double>(all.size() - 1);
  const auto last = all.last(all.size() / 3);
  const double rest = settling.rest = mean_of(last);
  const double sigma = sigma_of(last);
  const double tolerance = std::max(kSigmas * sigma, kRestTolerance * rest);
  std::vector<bool> is_off;
  for (const AfterMove& frame : all) {
    const double deviation = std::abs(frame.score - rest);
    settling.change = std::max(settling.change, rest > 0 ? deviation / rest : 0);
    is_off.push_back(deviation > tolerance);
  }
  const std::size_t first_at_rest = first_after_last_run(is_off);
  settling.is_at_rest =
      !drifts(last, sigma, kRestTolerance * rest) && first_at_rest <= all.size() - last.size();
  if (first_at_rest > 0 && first_at_rest < all.size()) {
    settling.settled_ms = std::max(all[first_at_rest].since_ms, 0.0);
  }
  return settling;
}

Settling measure_settling(Rig& rig, double from, double to, double rest_ms, double watch_ms) {
  const ShotOptions& shot = rig.options().shot;
  const Arrival there = arrive(rig.lens(), rig.lens().nearest(from));
  take_frame(rig.camera(), there.settled_ns + static_cast<std::int64_t>(rest_ms * 1e6), shot);
  const Arrival arrival = arrive(rig.lens(), rig.lens().nearest(to));
  const auto since_ms = [&](const Frame& frame) {
    return 1e-6 * static_cast<double>(frame.exposure.start_ns - arrival.stopped_ns);
  };
  std::vector<AfterMove> frames;
  std::int64_t ended_ns = 0;
  while (frames.size() < kFewestFrames || frames.back().since_ms < watch_ms) {
    // Frames from before the move would only say where the lens was.
    const Frame frame = take_frame(rig.camera(), arrival.started_ns, shot);
    frames.push_back({since_ms(frame), rig.score(frame)});
    ended_ns = frame.exposure.end_ns;
  }
  Settling settling = judge_settling(std::move(frames));
  settling.ended_ns = ended_ns;
  return settling;
}

}  // namespace fathom
