// SPDX-License-Identifier: Apache-2.0
#include "session/hill.hpp"

#include <algorithm>
#include <cmath>

#include "backends/backends.hpp"
#include "focus/noise.hpp"

namespace fathom {
namespace {

constexpr int kFirstSweep = 41;        // positions over the whole travel
constexpr int kHalvings = 2;           // of their spacing, at most
constexpr int kCloseSweep = 17;        // positions round what stands out
constexpr int kCloser = 3;             // sweeps round it, at most
constexpr std::size_t kOnTheHill = 5;  // positions on its upper half that are enough
constexpr double kClear = 3;           // times the rise that is needed: nobody wants another metric
constexpr double kFarClearer = 2;      // so many times as clear

// How long after a small step, and after a long way that a driver says took no time, a frame begins
// at the earliest: the motor may still run. The second time there is more of it.
constexpr double kSmallStep_ms = 500;
constexpr double kLongWay_ms = 5000;
constexpr double kMorePatience = 4;

std::vector<double> spread(const Lens& lens, double low, double high, int count) {
  std::vector<double> positions;
  for (int i = 0; i < count; ++i) {
    const double position = lens.nearest(low + (high - low) * i / (count - 1));
    if (positions.empty() || position > positions.back()) positions.push_back(position);
  }
  return positions;
}

std::vector<double> between(const Lens& lens, const std::vector<double>& positions) {
  std::vector<double> middles;
  for (std::size_t i = 1; i < positions.size(); ++i) {
    const double middle = lens.nearest((positions[i - 1] + positions[i]) / 2);
    if (middle > positions[i - 1] && middle < positions[i]) middles.push_back(middle);
  }
  return middles;
}

std::int64_t in_ns(double ms) { return static_cast<std::int64_t>(ms * 1e6); }

/// One aim and what it has seen.
struct View {
  Aim aim;
  Scorer scorer;
  std::vector<Evaluation> seen;
  double repeat = 0;  ///< Relative scatter of frames at one place.

  View(Rig& rig, const Aim& what)
      : aim(what),
        scorer(select_device(all_backends(), rig.options().backend, what.metric, 1,
                             rig.options().device),
               what.metric, what.window) {}

  FocusCurve curve() const { return FocusCurve(seen); }
  Rise rise() const { return rise_of(curve(), Scatter(aim.metric, repeat)); }
};

/// Looks with several aims at once.
class Lookout {
 public:
  Lookout(Rig& rig, std::span<const Aim> aims, double patience) : rig_(rig), patience_(patience) {
    for (const Aim& aim : aims) views_.emplace_back(rig, aim);
  }

  /// One way upward. repeats: at the first position, to learn how far scores repeat.
  void sweep(const std::vector<double>& positions, bool repeats) {
    if (positions.empty()) return;
    const RunUp before = run_up(rig_, positions.front(), true);
    take_frame(rig_.camera(), rested_ns(before.arrival, before.distance), rig_.options().shot);
    for (const double position : positions) {
      const std::int64_t rested_ns = this->rested_ns(arrive(rig_.lens(), position), 0);
      if (repeats && position == positions.front()) learn_repeats(rested_ns);
      const Frame frame = take_frame(rig_.camera(), rested_ns, rig_.options().shot);
      for (View& view : views_) {
        const int loop = static_cast<int>(view.seen.size()) + 1;
        view.seen.push_back({loop, position, view.scorer.score(frame)});
      }
    }
  }

  /// Where something stands out, the first view, or the one where it does so far more; or null.
  View* clearest() {
    const auto clear = [](const View& view) {
      const Rise rise = view.rise();
      return rise.stands_out() ? rise.rise / std::max(rise.needed, 1e-9) : 0;
    };
    View* const best =
        &*std::max_element(views_.begin(), views_.end(),
                           [&](const View& a, const View& b) { return clear(a) < clear(b); });
    const double most = clear(*best), own = clear(views_.front());
    if (most == 0) return nullptr;
    return own >= kClear || own * kFarClearer >= most ? &views_.front() : best;
  }

  /// Whether every move so far took no time, if one is to believe the driver.
  bool is_doubtful() const { return is_doubtful_; }

  void forget() {
    for (View& view : views_) view.seen.clear();
  }

 private:
  std::int64_t rested_ns(const Arrival& arrival, double distance) {
    const LensInfo info = rig_.lens().info();
    is_doubtful_ = is_doubtful_ && took_no_time(rig_, arrival);
    const bool is_far = distance > kPlayOfTravel * (info.highest - info.lowest) / 2;
    const double rest_ms = is_far ? kLongWay_ms : kSmallStep_ms;
    return arrival.settled_ns + (is_doubtful_ ? in_ns(patience_ * rest_ms) : 0);
  }

  void learn_repeats(std::int64_t rested_ns) {
    if (!rig_.camera().is_live()) return;
    std::vector<std::vector<double>> scores(views_.size());
    for (int i = 0; i < kRepeatFrames; ++i) {
      const Frame frame = take_frame(rig_.camera(), rested_ns, rig_.options().shot);
      for (std::size_t v = 0; v < views_.size(); ++v)
        scores[v].push_back(views_[v].scorer.score(frame));
    }
    for (std::size_t v = 0; v < views_.size(); ++v) views_[v].repeat = relative_scatter(scores[v]);
  }

  Rig& rig_;
  double patience_;
  bool is_doubtful_ = true;
  std::vector<View> views_;
};

/// First and last position of the upper half of the best peak.
std::pair<std::size_t, std::size_t> upper_half(const FocusCurve& curve, double floor) {
  return reach(curve.evaluations(), curve.best(), floor + (curve.top().score - floor) / 2);
}

/// Sweeps closer and closer, until enough positions lie on the hill.
std::optional<Hill> look_closer(Rig& rig, Lookout& lookout, const View& view, double floor) {
  for (int i = 0;; ++i) {
    const FocusCurve curve = view.curve();
    const std::size_t best = curve.best();
    if (best == 0 || best + 1 == curve.size()) return std::nullopt;
    const auto [first, last] = upper_half(curve, floor);
    if (last - first + 1 >= kOnTheHill) {
      const Peak peak = fit_peak(curve.evaluations(), best, floor, noise_of(view.repeat, floor));
      if (peak.shape == PeakShape::none || !(peak.half_width > 0)) return std::nullopt;
      return Hill{peak.position, peak.half_width, floor, peak.score - floor};
    }
    if (i == kCloser) return std::nullopt;
    const double low = curve[first > 0 ? first - 1 : 0].position;
    const double high = curve[std::min(last + 1, curve.size() - 1)].position;
    const double margin = (high - low) / 4;
    const LensInfo info = rig.lens().info();
    lookout.forget();
    lookout.sweep(spread(rig.lens(), std::max(low - margin, info.lowest),
                         std::min(high + margin, info.highest), kCloseSweep),
                  false);
  }
}

std::optional<SeenHill> look_everywhere(Rig& rig, Lookout& lookout, int halvings) {
  const LensInfo info = rig.lens().info();
  std::vector<double> all = spread(rig.lens(), info.lowest, info.highest, kFirstSweep);
  lookout.sweep(all, true);
  View* view = lookout.clearest();
  for (int i = 0; view == nullptr && i < halvings; ++i) {
    const std::vector<double> more = between(rig.lens(), all);
    if (more.empty()) break;
    lookout.sweep(more, false);
    all.insert(all.end(), more.begin(), more.end());
    std::sort(all.begin(), all.end());
    view = lookout.clearest();
  }
  if (view == nullptr) return std::nullopt;
  const auto hill = look_closer(rig, lookout, *view, view->curve().floor());
  return hill ? std::optional<SeenHill>({*hill, view->aim}) : std::nullopt;
}

}  // namespace

bool took_no_time(Rig& rig, const Arrival& arrival) {
  constexpr std::int64_t kNoTime_ns = 100'000'000;
  return rig.camera().is_live() && arrival.stopped_ns - arrival.started_ns < kNoTime_ns;
}

Hill hill_of(const Focus& focus) {
  return {focus.position(), focus.lobes[0].half_width, focus.floor,
          focus.lobes[0].score - focus.floor};
}

std::vector<Aim> aims_to_try(Rig& rig) {
  const CameraSettings picture = rig.camera().settings();
  const int n = rig.window().n;
  std::vector<Aim> aims{{rig.spec(), rig.window()}};
  const auto add = [&](MetricSpec metric, Window window) {
    metric.n = window.n;
    if (fits(window, picture.width_px, picture.height_px)) aims.push_back({metric, window});
  };
  const auto middle = [&](int x, int y, int side) {
    return Window{std::max(x - side / 2, 0), std::max(y - side / 2, 0), side};
  };
  const int w = picture.width_px, h = picture.height_px;
  const MetricSpec walsh = MetricSpec::parse("walsh-sequency");
  add(walsh, rig.window());
  if (2 * n <= kLargestWindow) {
    add(rig.spec(), middle(w / 2, h / 2, 2 * n));
    add(walsh, middle(w / 2, h / 2, 2 * n));
  }
  for (const auto& [x, y] : {std::pair{1, 1}, {3, 1}, {1, 3}, {3, 3}})
    add(walsh, middle(x * w / 4, y * h / 4, n));
  return aims;
}

RunUp run_up(Rig& rig, double start, bool up) {
  const LensInfo info = rig.lens().info();
  const double way = kPlayOfTravel * (info.highest - info.lowest);
  const double before =
      rig.lens().nearest(std::clamp(up ? start - way : start + way, info.lowest, info.highest));
  const double from = rig.lens().position();
  return {arrive(rig.lens(), before), std::abs(before - from)};
}

std::optional<Hill> see_again(Rig& rig, const Hill& hill) {
  constexpr double kAround = 4;  // half-widths to either side
  const LensInfo info = rig.lens().info();
  const double around = std::max(kAround * hill.half_width, kCloseSweep * info.resolution / 2);
  const Aim own{rig.spec(), rig.window()};
  Lookout lookout(rig, {&own, 1}, 1);
  lookout.sweep(spread(rig.lens(), std::max(hill.position - around, info.lowest),
                       std::min(hill.position + around, info.highest), kCloseSweep),
                true);
  View* const view = lookout.clearest();
  if (view == nullptr || view->curve().top().score - hill.floor < hill.height / 2)
    return std::nullopt;
  return look_closer(rig, lookout, *view, hill.floor);
}

std::optional<SeenHill> find_hill(Rig& rig, std::span<const Aim> aims) {
  Lookout lookout(rig, aims, 1);
  if (const auto sighting = look_everywhere(rig, lookout, kHalvings)) return sighting;
  if (!lookout.is_doubtful()) return std::nullopt;
  Lookout patient(rig, aims, kMorePatience);
  return look_everywhere(rig, patient, kHalvings - 1);
}

}  // namespace fathom
