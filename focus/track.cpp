// SPDX-License-Identifier: Apache-2.0
#include "focus/track.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "focus/searches.hpp"

namespace fathom {

std::vector<Evaluation> floor_seen_by(const Focus& before) {
  std::vector<Evaluation> far;
  for (const auto* seen : {&before.background, &before.evaluations}) {
    for (const Evaluation& e : *seen) {
      const double away = std::abs(e.position - before.peak.position);
      if (away > kPeakReach * before.peak.half_width) far.push_back(e);
    }
  }
  return far;
}

namespace {

/// Sightings that are older than this, s, say nothing of where the peak is now.
constexpr double kMemory = 12;
constexpr std::size_t kFewest = 3, kMost = 8;
/// A position that is known to this part of the half width is known well enough.
constexpr double kWellKnown = 0.03;
/// A position that is not even known so well is none.
constexpr double kBarelyKnown = 0.3;
/// What a score of the peak's shape is off by at least, as a part of the height: a shape is a likeness.
constexpr double kUnlikeScore = 0.01;
/// Mean square of the residuals, in their sigmas, beyond which the scores tell no one story.
constexpr double kMostMisfit = 9;

/// Scores and when they were taken, whether a search asks for them or this.
class Watch {
 public:
  Watch(const TimedObjective& timed, std::span<const Sighting> seen) : timed_(timed) {
    for (const Sighting& sighting : seen) {
      if (!sightings_.empty())
        learn_pace(std::abs(sighting.position - last_position()), sighting.time_s - last_s());
      sightings_.push_back(sighting);
    }
  }

  Sample score_at(double wanted) {
    const double position = timed_.objective.nearest(wanted);
    const Sample sample = timed_.objective.score(position);
    made_.push_back({static_cast<int>(made_.size()) + 1, position, sample.score, sample.picture});
    const double now_s = timed_.time_s();
    if (!sightings_.empty()) learn_pace(std::abs(position - last_position()), now_s - last_s());
    sightings_.push_back({position, sample.score, now_s});
    return sample;
  }
  Objective objective() {
    return {[this](double position) { return score_at(position); }, timed_.objective.nearest};
  }

  const std::vector<Evaluation>& made() const { return made_; }
  /// Those that still count.
  std::span<const Sighting> recent() const {
    const std::span<const Sighting> all = sightings_;
    std::size_t first = all.size();
    while (first > 0 && all.back().time_s - all[first - 1].time_s <= kMemory) --first;
    return all.subspan(first);
  }
  double last_s() const { return sightings_.back().time_s; }
  double last_position() const { return sightings_.back().position; }
  /// How long an evaluation there will take, s, by how long the last ones took.
  double duration_s(double position) const {
    constexpr double kLongest = 10;
    const double way = std::abs(position - last_position());
    return std::min(shortest_s_ + way * per_unit_s_, kLongest);
  }

 private:
  /// A long way tells how fast the lens is, the shortest time what else an evaluation takes.
  void learn_pace(double way, double took_s) {
    shortest_s_ = sightings_.size() == 1 ? took_s : std::min(shortest_s_, took_s);
    if (way > longest_way_ && took_s > shortest_s_) {
      longest_way_ = way;
      per_unit_s_ = (took_s - shortest_s_) / way;
    }
  }

  const TimedObjective& timed_;
  std::vector<Evaluation> made_;
  std::vector<Sighting> sightings_;
  double shortest_s_ = 0, per_unit_s_ = 0, longest_way_ = 0;
};

/// What a focus says of the peak to come. doubt: of height and width, as parts of them.
PeakTemplate template_of(const Focus& focus, const Scatter& scatter, double doubt) {
  return {.floor = focus.floor,
          .height = focus.peak.score - focus.floor,
          .height_part = doubt,
          .half_width = focus.peak.half_width,
          .width_part = doubt,
          .noise = std::hypot(scatter.repeat * focus.floor,
                              kUnlikeScore * (focus.peak.score - focus.floor))};
}

bool has_peak(const Focus& focus) {
  return focus.peak.half_width > 0 && focus.peak.score > focus.floor;
}

/// Where everything lies that was seen, and what lies near it.
MovingPeak locate_near(const Watch& watch, const PeakTemplate& peak, const FocusLimits& limits) {
  const auto recent = watch.recent();
  const auto [low, high] = std::minmax_element(
      recent.begin(), recent.end(),
      [](const Sighting& a, const Sighting& b) { return a.position < b.position; });
  const double reach = kPeakReach * peak.half_width;
  return locate(recent, peak, std::max(limits.from, low->position - reach),
                std::min(limits.to, high->position + reach));
}

/// Whether scores fall on both sides of the peak: a slope that rises to the end of what may be
/// searched has its peak elsewhere.
bool is_enclosed(const MovingPeak& found, const PeakTemplate& peak, const Watch& watch) {
  constexpr double kBeside = 0.35, kNear = 3, kFallen = 0.9;
  bool below = false, above = false;
  for (const Sighting& sighting : watch.recent()) {
    const double z = (sighting.position - found.position_at(sighting.time_s)) / found.half_width;
    if (std::abs(z) < kBeside || std::abs(z) > kNear) continue;
    if (sighting.score - peak.floor > kFallen * found.height) continue;
    (z < 0 ? below : above) = true;
  }
  return below && above;
}

/// Whether the evaluations from number `first` on saw the peak: one of them stands half as high,
/// and all that is known tells of one place.
bool is_followed(const MovingPeak& found, const PeakTemplate& peak, const Watch& watch,
                 std::size_t first, const FocusLimits& limits) {
  double best = 0;
  for (std::size_t i = first; i < watch.made().size(); ++i)
    best = std::max(best, watch.made()[i].score - peak.floor);
  return best > found.height / 2 && best > peak.height / 3 &&
         found.sigma < kBarelyKnown * found.half_width && found.misfit < kMostMisfit &&
         found.position - found.sigma > limits.from && found.position + found.sigma < limits.to &&
         is_enclosed(found, peak, watch);
}

/// Where the peak, or a place beside it, will be once the lens has come there.
double meeting_place(const MovingPeak& found, double beside, const Watch& watch,
                     const FocusLimits& limits) {
  double place = found.position + beside;
  for (int i = 0; i < 3; ++i) {
    const double then_s = watch.last_s() + watch.duration_s(place);
    place = std::clamp(found.position_at(then_s) + beside, limits.from, limits.to);
  }
  return place;
}

/// Looks at slopes and top in turn, where they will be by then; at the top alone, while that is
/// hardly known.
std::optional<MovingPeak> follow(Watch& watch, const PeakTemplate& peak,
                                 const FocusLimits& limits) {
  constexpr double kPlaces[] = {-0.7, 0.7, 0, -0.7, 0.7, -0.4, 0.4, 0};
  constexpr double kLost = 0.7;
  const std::size_t first = watch.made().size();
  MovingPeak found = locate_near(watch, peak, limits);
  for (std::size_t i = 0, place = 0; i < kMost; ++i) {
    const bool lost = found.sigma > kLost * found.half_width;
    const double beside = lost ? 0 : kPlaces[place++] * found.half_width;
    watch.score_at(meeting_place(found, beside, watch, limits));
    found = locate_near(watch, peak, limits);
    if (i + 1 >= kFewest && found.sigma < kWellKnown * found.half_width &&
        is_followed(found, peak, watch, first, limits)) {
      return found;
    }
  }
  if (!is_followed(found, peak, watch, first, limits)) return std::nullopt;
  return found;
}

/// Of the picture that scored best, whose saturated pixels show nothing.
double saturated_at_best(const Watch& watch) {
  return watch.made().empty() ? 0 : best_of(watch.made()).picture.saturated;
}

/// The answer at the last evaluation. The shape is a likeness, and the target goes as it likes
/// between two looks: no position is known better than to a part of the width.
Peak peak_of(const MovingPeak& found, const PeakTemplate& peak, const Watch& watch) {
  constexpr double kUnlike = 0.035;
  return {.shape = PeakShape::lorentzian,
          .position = found.position,
          .sigma = std::hypot(found.sigma, kUnlike * found.half_width,
                              saturation_sigma(saturated_at_best(watch), found.half_width)),
          .score = peak.floor + found.height,
          .half_width = found.half_width,
          .r_squared = 1 / (1 + 0.02 * found.misfit),
          .points = static_cast<int>(watch.recent().size()),
          .parameters = 4};
}

Verdict verdict_of(const Focus& focus, const MovingPeak& found, double saturated,
                   const Scatter& scatter) {
  std::vector<Evaluation> all = focus.background;
  all.insert(all.end(), focus.evaluations.begin(), focus.evaluations.end());
  Verdict verdict;
  verdict.rise = rise_of(FocusCurve(std::move(all)), scatter);
  const Rise& rise = verdict.rise;
  const double sure = rise.rise > 0 ? std::max(0.0, 1 - rise.needed / rise.rise) : 0;
  const double known = 1 - found.sigma / (kBarelyKnown * found.half_width);
  const double confidence =
      sure * focus.peak.r_squared * std::clamp(known, 0.0, 1.0) * (1 - saturated);
  const bool focused = rise.stands_out() && confidence >= kLeastConfidence;
  verdict.result = focused ? FocusResult::focused : FocusResult::no_focus;
  verdict.confidence = focused ? confidence : 0;
  verdict.reason = {.why = focused             ? Why::stands_out
                           : rise.stands_out() ? Why::unsure
                                               : Why::within_noise,
                    .position = focus.peak.position,
                    .r_squared = focus.peak.r_squared,
                    .confidence = confidence,
                    .is_live = true,
                    .saturated = saturated,
                    .transform = scatter.spec.transform,
                    .evaluations = static_cast<int>(focus.evaluations.size())};
  return verdict;
}

Focus focus_of(const MovingPeak& found, const PeakTemplate& peak, const Watch& watch,
               std::vector<Evaluation> background, const Scatter& scatter) {
  Focus focus;
  focus.evaluations = watch.made();
  focus.background = std::move(background);
  focus.floor = peak.floor;
  focus.peak = peak_of(found, peak, watch);
  focus.lobes = {focus.peak};
  focus.verdict = verdict_of(focus, found, saturated_at_best(watch), scatter);
  return focus;
}

/// The half width that a coarse pass is made for, where the lens vouches for it: half a spacing
/// beside the peak its score still stands clear of the floor. 0 where nobody knows.
double expected_width(const FocusLimits& limits) {
  const std::vector<double>& coarse = limits.coarse.positions;
  if (limits.coarse.is_guess || coarse.size() < 2) return 0;
  constexpr double kOfSpacing = 5;
  return (coarse.back() - coarse.front()) / static_cast<double>(coarse.size() - 1) / kOfSpacing;
}

/// A width that a target in motion has falsified is not believed: no peak is so much narrower than
/// what the coarse pass is made for.
void mend_width(PeakTemplate& peak, const FocusLimits& limits) {
  constexpr double kNarrow = 0.4, kDoubt = 0.35;
  const double expected = expected_width(limits);
  if (peak.half_width > kNarrow * expected) return;
  peak.half_width = expected;
  peak.width_part = kDoubt;
}

/// Half of the width that the points above half the height take; 0 where two or fewer say nothing
/// of it.
double width_of(const FocusCurve& curve) {
  const double half = curve.floor() + curve.height() / 2;
  const auto [first, last] = reach(curve.evaluations(), curve.best(), half);
  return last - first < 2 ? 0 : (curve[last].position - curve[first].position) / 2;
}

/// A coarse pass that ends as soon as it has passed a peak, because that will not wait. The peak
/// as it looks then; nothing where none was seen.
std::optional<PeakTemplate> pass_a_peak(Watch& watch, const FocusLimits& limits,
                                        const Scatter& scatter) {
  constexpr std::size_t kEnough = 3;
  constexpr double kDoubt = 0.35, kUnseen = 1.3;  // the top is higher than what was met of it
  std::vector<Evaluation> pass;
  for (const double position : limits.coarse.positions) {
    watch.score_at(position);
    pass.push_back(watch.made().back());
    const FocusCurve curve{pass};
    const bool passed = curve.size() >= kEnough && curve.best() + 1 < curve.size() &&
                        curve.back().score < curve.floor() + curve.height() / 2;
    if (!passed || !rise_of(curve, scatter).stands_out()) continue;
    return PeakTemplate{
        .floor = curve.floor(),
        .height = kUnseen * curve.height(),
        .height_part = 1,
        .half_width = std::max(expected_width(limits), width_of(curve)),
        .width_part = kDoubt,
        .noise = std::hypot(scatter.repeat * curve.floor(), kUnlikeScore * curve.height())};
  }
  return std::nullopt;
}

/// What is told of a peak that was seen and does not stay.
Focus lost(Focus focus, const Watch& watch) {
  focus.evaluations = watch.made();
  if (focus.result() != FocusResult::focused) return focus;
  focus.verdict.result = FocusResult::no_focus;
  focus.verdict.confidence = 0;
  focus.verdict.reason.why = Why::no_shape;
  return focus;
}

/// A search of everything, whose peak is then followed.
Focus search_and_follow(Watch& watch, const FocusLimits& limits, const Scatter& scatter) {
  constexpr double kDoubt = 0.35;
  SearchTrace trace(watch.objective(), scatter.light);
  search_of(limits.search).run(trace, limits, scatter);
  Focus focus = judge_search(trace, limits, scatter);
  if (focus.result() != FocusResult::focused || !has_peak(focus)) return lost(focus, watch);
  PeakTemplate peak = template_of(focus, scatter, kDoubt);
  mend_width(peak, limits);
  const std::vector<Evaluation> far = floor_seen_by(focus);
  if (const auto found = follow(watch, peak, limits))
    return focus_of(*found, peak, watch, far, scatter);
  return lost(focus, watch);
}

/// The same where the lens knows how wide a peak is.
Focus pass_and_follow(Watch& watch, const FocusLimits& limits, const Scatter& scatter) {
  const auto peak = pass_a_peak(watch, limits, scatter);
  if (!peak) return search_and_follow(watch, limits, scatter);
  if (const auto found = follow(watch, *peak, limits))
    return focus_of(*found, *peak, watch, {}, scatter);
  SearchTrace trace({});
  trace.remember(watch.made());
  return lost(judge_search(trace, limits, scatter), watch);
}

}  // namespace

Focus track_focus(const TimedObjective& timed, const FocusLimits& limits, const MetricSpec& spec,
                  double repeat_scatter, const Focus& before, std::span<const Sighting> seen) {
  constexpr double kDoubt = 0.2;
  const Scatter scatter(spec, repeat_scatter);
  Watch watch(timed, seen);
  // A peak that moved between two looks is no answer, but a place to follow it from.
  const bool was_seen =
      before.result() == FocusResult::focused || before.verdict.reason.why == Why::changed;
  const bool can_follow = was_seen && has_peak(before) && !seen.empty();
  if (can_follow) {
    PeakTemplate peak = template_of(before, scatter, kDoubt);
    mend_width(peak, limits);
    if (const auto found = follow(watch, peak, limits)) {
      Focus focus = focus_of(*found, peak, watch, floor_seen_by(before), scatter);
      if (focus.result() == FocusResult::focused) return focus;
    }
  }
  return expected_width(limits) > 0 ? pass_and_follow(watch, limits, scatter)
                                    : search_and_follow(watch, limits, scatter);
}

}  // namespace fathom
