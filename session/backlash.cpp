// SPDX-License-Identifier: Apache-2.0
#include "session/backlash.hpp"

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr double kSigmas = 3;

/// Where one way runs: equal steps that the lens can tell apart, inside of its travel.
std::vector<double> positions_round(const Lens& lens, double focus, double reach) {
  const LensInfo info = lens.info();
  const double low = std::max(focus - reach, info.lowest);
  const double high = std::min(focus + reach, info.highest);
  std::vector<double> positions;
  for (int i = 0; i < kBacklashPositions; ++i) {
    const double position = lens.nearest(low + (high - low) * i / (kBacklashPositions - 1));
    if (positions.empty() || position > positions.back()) positions.push_back(position);
  }
  return positions;
}

double settled_score(Rig& rig, double position, double rest_ms) {
  const Arrival arrival = arrive(rig.lens(), position);
  const std::int64_t rest_ns = arrival.settled_ns + static_cast<std::int64_t>(rest_ms * 1e6);
  return rig.score(take_frame(rig.camera(), rest_ns, rig.options().shot));
}

/// One way over the positions, in their order, beginning further out on the same side, so that the
/// play is taken up when the first one comes.
Peak peak_on_the_way(Rig& rig, const std::vector<double>& positions, double floor, double rest_ms) {
  const LensInfo info = rig.lens().info();
  const double run_up = positions.front() - (positions.back() - positions.front());
  arrive(rig.lens(), rig.lens().nearest(std::clamp(run_up, info.lowest, info.highest)));
  std::vector<Evaluation> curve;
  for (const double position : positions)
    curve.push_back(
        {static_cast<int>(curve.size()) + 1, position, settled_score(rig, position, rest_ms)});
  const FocusCurve sorted(std::move(curve));
  const Peak peak = fit_peak(sorted.evaluations(), sorted.best(), floor, {});
  if (peak.shape != PeakShape::none) return peak;
  throw Error(ErrorCode::bad_data,
              "no peak to measure the backlash by; is something moving in the picture?");
}

}  // namespace

double Backlash::sigma() const { return std::hypot(up.sigma, down.sigma); }

bool Backlash::is_certain() const { return std::abs(play()) > kSigmas * sigma(); }

double Backlash::suggestion(double resolution) const {
  if (!is_certain() || play() <= 0) return 0;
  return std::ceil((play() + 2 * sigma()) / resolution) * resolution;
}

Backlash measure_backlash(Rig& rig, double focus, double reach, double floor, double rest_ms) {
  std::vector<double> positions = positions_round(rig.lens(), focus, reach);
  Backlash backlash;
  backlash.up = peak_on_the_way(rig, positions, floor, rest_ms);
  std::reverse(positions.begin(), positions.end());
  backlash.down = peak_on_the_way(rig, positions, floor, rest_ms);
  return backlash;
}

}  // namespace fathom
