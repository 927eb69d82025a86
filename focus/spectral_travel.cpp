// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_travel.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "focus/focus.hpp"
#include "focus/spectral_side.hpp"

namespace fathom {
namespace {

// Lengths of the way, as blur that they add, px.
constexpr double kApartPx = 0.5;    ///< Pictures are looked at so far from each other,
constexpr double kSeldomPx = 4;     ///< so often while the focus is not known,
constexpr double kEveryPx = 2.5;    ///< while it is,
constexpr double kOftenPx = 1;      ///< and while it is near.
constexpr double kTruePx = 4;       ///< A false focus has run away after so much more.
constexpr double kBlindPx = 25;     ///< What changes nothing on so long a way is no focus.
constexpr double kDistrustPx = 10;  ///< From where a fit has misled.
constexpr int kMostLegs = 3;        ///< There and back, and back once more.

/// How the coarsest rings change along a part of the way: a straight line through ln of their power.
struct Trend {
  double slope = 0;  ///< For each unit of the lens.
  double sigma = 0;
  double span = 0;  ///< From the lowest to the highest picture.
};

/// ln of the coarsest rings' power of one picture, over that of the first.
struct CoarsePower {
  double position = 0;
  double part = 0;
  double sigma = 0;
};

/// Nothing for fewer than four pictures.
std::optional<Trend> trend_of(std::span<const CoarsePower> powers) {
  if (powers.size() < 4) return std::nullopt;
  double weights = 0, position = 0, part = 0;
  const auto [low, high] = std::minmax_element(
      powers.begin(), powers.end(),
      [](const CoarsePower& a, const CoarsePower& b) { return a.position < b.position; });
  for (const CoarsePower& p : powers) {
    const double weight = 1 / (p.sigma * p.sigma);
    weights += weight;
    position += weight * (p.position - position) / weights;
    part += weight * (p.part - part) / weights;
  }
  double squares = 0, products = 0, rest = 0;
  for (const CoarsePower& p : powers) {
    const double weight = 1 / (p.sigma * p.sigma), away = p.position - position;
    squares += weight * away * away;
    products += weight * away * (p.part - part);
    rest += weight * (p.part - part) * (p.part - part);
  }
  if (!(squares > 0)) return std::nullopt;
  const double slope = products / squares;
  const double scatter = (rest - slope * products) / static_cast<double>(powers.size() - 2);
  return Trend{.slope = slope,
               .sigma = std::sqrt(std::max(1.0, scatter) / squares),
               .span = high->position - low->position};
}

class Traveller {
 public:
  Traveller(SearchTrace& trace, const FocusLimits& limits, const Way& begin)
      : trace_(trace),
        limits_(limits),
        model_(*limits.blur),
        sides_(ring_sides(trace.evaluations())),
        way_(begin),
        misled_at_(begin.here),
        distrust_(begin.fit.side != 0 ? model_.units(kDistrustPx) : 0) {
    for (const Evaluation& e : trace.seen()) note_power(e);
  }

  Way run() {
    for (int leg = 0; leg < kMostLegs; ++leg) {
      begun_ = fitted_ = way_.here;
      stop_ = Stop::none;
      const double end = trace_.nearest(way_.direction > 0 ? limits_.to : limits_.from);
      const std::size_t before = trace_.evaluations().size();
      trace_.travel(end, model_.units(kApartPx), [this] { return goes_on(); });
      if (trace_.evaluations().size() > before) {  // it was halted
        stop_ = Stop::useless;
        way_.here = trace_.evaluations().back().position;
      }
      if (stop_ == Stop::told) return ended(WayEnd::told);
      if (stop_ == Stop::blind) return ended(WayEnd::nothing_changes);
      if (stop_ == Stop::useless) return ended(WayEnd::unclear);
      if (stop_ == Stop::none && !is_behind_end(end)) return ended(WayEnd::unclear);
      way_.direction = -way_.direction;
    }
    return ended(WayEnd::unclear);
  }

 private:
  enum class Stop { none, told, behind, blind, useless };

  static constexpr double kLamp = 0.004;  ///< What is left of a lamp whose light was divided out.

  Way ended(WayEnd end) {
    way_.end = end;
    if (end == WayEnd::told) way_.fit = fit_;
    return way_;
  }

  bool stops(Stop stop) {
    stop_ = stop;
    return false;
  }

  /// Of the newest picture.
  bool goes_on() {
    const Evaluation& e = trace_.passed().back();
    const double since_before = std::abs(e.position - way_.here);
    way_.here = e.position;
    if (!is_worth_it(*e.on_the_way, since_before, model_)) return stops(Stop::useless);
    note_power(e);
    if (is_time_to_fit()) fit();
    if (is_told()) return stops(Stop::told);
    if (!is_sure_ && is_behind()) return stops(Stop::behind);
    if (is_blind()) return stops(Stop::blind);
    return true;
  }

  void note_power(const Evaluation& e) {
    const CoarseChange change = coarse_change(trace_.evaluations().front(), e, sides_.largest);
    powers_.push_back(
        {.position = e.position, .part = change.part, .sigma = std::hypot(change.sigma, kLamp)});
  }

  double ahead() const { return way_.direction * (fit_.position - way_.here); }

  bool is_time_to_fit() const {
    constexpr double kNearPx = 6;
    const bool is_near = is_sure_ && std::abs(ahead()) < model_.units(kNearPx);
    const double wait_px = is_near ? kOftenPx : is_sure_ ? kEveryPx : kSeldomPx;
    return std::abs(way_.here - fitted_) >= model_.units(wait_px);
  }

  /// Far from the focus, where light from outside of the window takes part, any pictures fit a focus
  /// nearby, which runs away from the lens. A true one stays.
  void fit() {
    fitted_ = way_.here;
    const std::vector<Evaluation> all = thinned(trace_, model_.units(kFittedPx));
    const SpectralFit before = fit_;
    fit_ = fit_all(all, way_.here, limits_);
    const bool is_inside = limits_.from <= fit_.position && fit_.position <= limits_.to;
    const bool was_sure = is_sure_;
    is_sure_ = std::abs(way_.here - misled_at_) >= distrust_ && is_sure(fit_) && is_inside &&
               !is_refuted() && is_possible_near(all, fit_.position, model_);
    if (is_sure_ && (!was_sure || !is_same_place(before, fit_, model_))) sure_since_ = way_.here;
  }

  /// Whether the coarsest rings say otherwise: a focus ahead lies where pictures become sharper, and
  /// one that was passed is sharper than what is behind it.
  bool is_refuted() const {
    if (ahead() > 0) return is_behind();
    constexpr double kSigmas = 3, kLeast = 0.01, kRoundPx = 1;
    const CoarsePower now = mean_round(way_.here, model_.units(kRoundPx));
    const CoarsePower there = mean_round(fit_.position, model_.units(kRoundPx));
    if (!(there.sigma > 0)) return false;
    return now.part - there.part > std::max(kSigmas * std::hypot(now.sigma, there.sigma), kLeast);
  }

  CoarsePower mean_round(double position, double distance) const {
    double weights = 0, part = 0;
    for (const CoarsePower& p : powers_) {
      if (std::abs(p.position - position) > distance) continue;
      const double weight = 1 / (p.sigma * p.sigma);
      weights += weight;
      part += weight * p.part;
    }
    if (!(weights > 0)) return {};
    return {.position = position, .part = part / weights, .sigma = 1 / std::sqrt(weights)};
  }

  /// Whether the lens is before the place from which the focus is passed at rest, or past it.
  bool is_told() const {
    if (!is_sure_) return false;
    const double wing = model_.units(kWingPx);
    const double sure_for = std::abs(way_.here - sure_since_);
    const bool is_true = sure_for >= model_.units(kTruePx);
    if (ahead() > 0) return is_true && ahead() <= wing + model_.units(kOftenPx);
    const bool was_passed = way_.direction * (fit_.position - begun_) > 0;
    return (is_true || (was_passed && sure_for >= model_.units(kOftenPx))) && ahead() <= -wing;
  }

  bool is_behind() const { return change_over({2.5, 5, 10}) * way_.direction < 0; }

  bool is_blind() const {
    return !is_sure_ && std::abs(way_.here - begun_) >= model_.units(kBlindPx) &&
           change_over({kBlindPx}) == 0;
  }

  /// Which way pictures become sharper for certain, on the last part of the way: +1 up, -1 down; 0
  /// where noise hides it.
  int change_over(std::initializer_list<double> lengths_px) const {
    for (const double length_px : lengths_px) {
      constexpr double kSigmas = 5, kLeast = 0.015, kMostOfIt = 0.8;
      const double length = model_.units(length_px);
      std::vector<CoarsePower> part;
      for (const CoarsePower& p : powers_) {
        if (std::abs(p.position - way_.here) <= length) part.push_back(p);
      }
      const auto trend = trend_of(part);
      if (!trend || trend->span < kMostOfIt * length) continue;
      const double change = std::abs(trend->slope) * trend->span;
      if (change > std::max(kSigmas * trend->sigma * trend->span, kLeast))
        return trend->slope > 0 ? 1 : -1;
    }
    return 0;
  }

  /// The lens has arrived where its travel ends. Whether the focus is behind for certain; not where a
  /// picture was taken there before, so that every travel is followed by a picture.
  bool is_behind_end(double end) {
    if (trace_.has(end)) return false;
    trace_.score_at(end);
    way_.here = end;
    return is_behind();
  }

  SearchTrace& trace_;
  const FocusLimits& limits_;
  const BlurModel& model_;
  RingSides sides_;
  Way way_;
  std::vector<CoarsePower> powers_;
  double begun_ = 0;   // where this leg began,
  double fitted_ = 0;  // and where its last fit was made
  SpectralFit fit_;
  bool is_sure_ = false;
  double sure_since_ = 0;
  double misled_at_ = 0;  // by a fit that was not true,
  double distrust_ = 0;   // and so far from there none is believed
  Stop stop_ = Stop::none;
};

}  // namespace

bool is_worth_it(const OnTheWay& way, double since_before, const BlurModel& model) {
  constexpr double kMostSmearPx = 2, kMostSigmaPx = 2, kMostApartPx = 5;
  return way.smear < model.units(kMostSmearPx) && way.sigma < model.units(kMostSigmaPx) &&
         since_before < model.units(kMostApartPx);
}

Way go_by_spectra(SearchTrace& trace, const FocusLimits& limits, const Way& begin) {
  return Traveller(trace, limits, begin).run();
}

std::vector<Evaluation> thinned(const SearchTrace& trace, double apart) {
  std::vector<Evaluation> chosen = trace.evaluations();
  const std::size_t at_rest = chosen.size();
  for (const Evaluation& e : trace.passed()) {
    const bool is_apart = std::none_of(
        chosen.begin() + static_cast<std::ptrdiff_t>(at_rest), chosen.end(),
        [&](const Evaluation& c) { return std::abs(c.position - e.position) < apart; });
    if (is_apart) chosen.push_back(e);
  }
  return chosen;
}

std::vector<Evaluation> floor_of_way(const SearchTrace& trace, double focus,
                                     const BlurModel& model) {
  constexpr double kMostSmearPx = 1;
  std::vector<Evaluation> chosen = thinned(trace, model.units(kHopPx));
  std::erase_if(chosen, [&](const Evaluation& e) {
    return !e.on_the_way || e.on_the_way->smear > model.units(kMostSmearPx) ||
           std::abs(e.position - focus) < model.units(kFloorPx);
  });
  return chosen;
}

}  // namespace fathom
