// SPDX-License-Identifier: Apache-2.0
#include "session/backlash.hpp"

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr double kSigmas = 3;
constexpr double kReach = 2;        // of a sweep, to either side, in half-widths
constexpr int kPerReach = 8;        // positions over that
constexpr double kFewestSteps = 6;  // of the lens, to either side

/// One sweep in one direction, and what it has seen so far.
class OneWay {
 public:
  /// Begins a sweep at a place. up: which way it runs.
  OneWay(Rig& rig, const RestAfter& rest_ms, double start, bool up) : rig_(rig), rest_ms_(rest_ms) {
    const RunUp before = run_up(rig, start, up);
    rested_frame(before.arrival, before.distance);
  }

  void look_at(double position) {
    const double distance = std::abs(position - rig_.lens().position());
    const Frame frame = rested_frame(arrive(rig_.lens(), position), distance);
    seen_.push_back({static_cast<int>(seen_.size()) + 1, position, rig_.score(frame)});
  }

  /// Whether a peak of at least half the hill's height lies behind: the last scores are down again.
  bool has_passed(const Hill& hill) const {
    constexpr std::size_t kDown = 5;
    constexpr double kLow = 0.4;
    if (seen_.size() < 2 * kDown) return false;
    const double height = best_of(seen_).score - hill.floor;
    if (height < hill.height / 2) return false;
    return std::all_of(seen_.end() - kDown, seen_.end(),
                       [&](const Evaluation& e) { return e.score - hill.floor < kLow * height; });
  }

  Peak peak(double floor) const {
    const FocusCurve sorted(seen_);
    const Peak peak = fit_peak(sorted.evaluations(), sorted.best(), floor, {});
    if (peak.shape != PeakShape::none) return peak;
    throw Error(ErrorCode::bad_data,
                "no peak to measure the backlash by; is something moving in the picture?");
  }

 private:
  Frame rested_frame(const Arrival& arrival, double distance) {
    const auto rest_ns = static_cast<std::int64_t>(rest_ms_(distance) * 1e6);
    return take_frame(rig_.camera(), arrival.settled_ns + rest_ns, rig_.options().shot);
  }

  Rig& rig_;
  const RestAfter& rest_ms_;
  std::vector<Evaluation> seen_;
};

/// Steps that the lens can tell apart.
double spacing_of(const Hill& hill, const LensInfo& lens) {
  const double reach = std::max(kReach * hill.half_width, kFewestSteps * lens.resolution);
  return std::max(std::round(reach / kPerReach / lens.resolution), 1.0) * lens.resolution;
}

Peak peak_going_up(Rig& rig, const Hill& hill, const RestAfter& rest_ms) {
  const LensInfo lens = rig.lens().info();
  const double step = spacing_of(hill, lens);
  const double first = std::max(hill.position - kPerReach * step, lens.lowest);
  const double last = std::min(hill.position + kPerReach * step, lens.highest);
  OneWay way(rig, rest_ms, first, true);
  for (double at = first; at <= last; at += step) way.look_at(rig.lens().nearest(at));
  return way.peak(hill.floor);
}

Peak peak_going_down(Rig& rig, const Hill& hill, const RestAfter& rest_ms) {
  const LensInfo lens = rig.lens().info();
  const double step = spacing_of(hill, lens);
  const double first = std::min(hill.position + kPerReach * step, lens.highest);
  const double last = std::max(
      hill.position - kPerReach * step - kPlayOfTravel * (lens.highest - lens.lowest), lens.lowest);
  OneWay way(rig, rest_ms, first, false);
  for (double at = first; at >= last && !way.has_passed(hill); at -= step)
    way.look_at(rig.lens().nearest(at));
  return way.peak(hill.floor);
}

}  // namespace

double Backlash::sigma() const { return std::hypot(up.sigma, down.sigma); }

bool Backlash::is_certain() const { return std::abs(play()) > kSigmas * sigma(); }

double Backlash::suggestion(double resolution) const {
  if (!is_certain() || play() <= 0) return 0;
  return std::ceil((play() + 2 * sigma()) / resolution) * resolution;
}

Backlash measure_backlash(Rig& rig, const Hill& hill, const RestAfter& rest_ms) {
  Backlash backlash;
  backlash.up = peak_going_up(rig, hill, rest_ms);
  backlash.down = peak_going_down(rig, hill, rest_ms);
  return backlash;
}

}  // namespace fathom
