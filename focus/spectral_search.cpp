// SPDX-License-Identifier: Apache-2.0
#include "focus/spectral_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "focus/focus.hpp"
#include "focus/spectral_pass.hpp"
#include "focus/spectral_side.hpp"
#include "focus/spectral_travel.hpp"

namespace fathom {
namespace {

constexpr int kMostHops = 40;
constexpr int kMostPasses = 4;
constexpr int kMostBlind = 3;  ///< Hops without any change, in one direction.

class Walk {
 public:
  Walk(SearchTrace& trace, const FocusLimits& limits)
      : trace_(trace), limits_(limits), model_(*limits.blur) {}

  SpectralEnd run() {
    look(limits_.start);
    sides_ = ring_sides(trace_.evaluations());
    if (sides_.largest == 0) return SpectralEnd::no_spectra;
    direction_ = limits_.to - here() >= here() - limits_.from ? 1 : -1;
    if (limits_.moves && trace_.can_travel()) {
      if (const auto end = travel()) return *end;
    }
    look(here() + direction_ * model_.units(kHopPx));
    if (trace_.evaluations().size() < 2) return SpectralEnd::lost;  // a lens that has one place
    return approach();
  }

  /// Where the pictures so far foretell a focus near there.
  bool pass_near(double place) {
    last_ = trace_.evaluations().back().position;
    sides_ = ring_sides(trace_.evaluations());
    fit_ = fit_all(pictures(), place, limits_);
    const bool is_inside = limits_.from <= fit_.position && fit_.position <= limits_.to;
    return is_sure(fit_) && is_inside && pass();
  }

 private:
  double here() const { return last_; }

  /// What there is to fit.
  std::vector<Evaluation> pictures() const { return thinned(trace_, model_.units(kFittedPx)); }

  /// Pictures that lie as far apart as hops would.
  std::vector<Evaluation> hops() const { return thinned(trace_, model_.units(kStridePx)); }

  void look(double wanted) {
    const double inside = std::clamp(wanted, limits_.from, limits_.to);
    trace_.score_at(inside);
    last_ = trace_.nearest(inside);
  }

  /// Without a halt; nothing where halts must tell.
  std::optional<SpectralEnd> travel() {
    constexpr int kMostWays = 3;
    Way way{.here = here(), .direction = direction_};
    for (int i = 0; i < kMostWays; ++i) {
      way = go_by_spectra(trace_, limits_, way);
      last_ = way.here;
      direction_ = way.direction;
      if (way.end == WayEnd::nothing_changes) return SpectralEnd::nothing_changes;
      if (way.end == WayEnd::unclear) return std::nullopt;
      fit_ = way.fit;
      if (pass()) return SpectralEnd::found;
      way.here = here();
      if (const int side = sharper_side(hops(), sides_.largest)) way.direction = side;
    }
    return std::nullopt;
  }

  /// Hops towards the sharper side. Far from the focus, where light from outside of the window takes
  /// part, any two pictures fit a focus nearby; a true one is still there after the next hop.
  SpectralEnd approach() {
    constexpr int kDistrust = 2;  // hops without the law after it has misled
    int blind = 0, distrust = 0;
    SpectralFit before;
    for (int hop = 0; hop < kMostHops; ++hop) {
      fit_ = fit_all(pictures(), here(), limits_);
      const bool is_inside = limits_.from <= fit_.position && fit_.position <= limits_.to;
      const bool sure =
          is_sure(fit_) && is_inside && is_possible_near(pictures(), fit_.position, model_);
      if (sure && distrust == 0 && is_same_place(before, fit_, model_)) {
        if (pass()) return SpectralEnd::found;
        distrust = kDistrust;
      }
      const bool was_sure = std::exchange(before, sure ? fit_ : SpectralFit{}).side != 0;
      const int side = sharper_side(hops(), sides_.largest);
      const std::optional<double> middle = side == 0 ? between_alike() : std::nullopt;
      blind = side == 0 && !middle ? blind + 1 : 0;
      if (blind >= kMostBlind) return SpectralEnd::nothing_changes;
      if (side != 0) direction_ = side;
      if (sure && distrust == 0) {
        look(towards_fit(was_sure));
        continue;
      }
      const std::optional<double> next = middle ? middle : next_hop();
      if (!next)
        return between_looks() ? SpectralEnd::does_not_defocus : SpectralEnd::beyond_travel;
      look(*next);
      distrust = std::max(0, distrust - 1);
    }
    return SpectralEnd::lost;
  }

  /// The place from which the fitted focus would be passed, or, where the lens stands there, its
  /// other side; no farther than a stride. is_second: it was elsewhere before, so a step is made that
  /// shows whether it will be there now.
  double towards_fit(bool is_second) const {
    const double wing = model_.units(kWingPx), away = fit_.position - here();
    const int way = away > 0 ? 1 : -1;
    const double before = fit_.position - way * wing, behind = fit_.position + way * wing;
    const double goal = std::abs(away) > 1.5 * wing ? before : behind;
    const double stride = model_.units(kStridePx), least = is_second ? stride / 2 : 0;
    const double step = std::clamp(std::abs(goal - here()), least, stride);
    return here() + (goal < here() ? -step : step);
  }

  /// Between the sharpest two pictures, which are alike, where the focus is there: the law says so, or
  /// other pictures are less sharp. Else nothing.
  std::optional<double> between_alike() const {
    const std::vector<Evaluation> all = hops();
    const auto [low, high] = around_sharpest(all, sides_.largest);
    const bool is_told = fit_.evidence > kLeastEvidence && low->position < fit_.position &&
                         fit_.position < high->position;
    const double apart = high->position - low->position;
    if (apart < model_.units(2 * kCloserPx) || !(is_told || changes(all, sides_.largest)))
      return std::nullopt;
    return (low->position + high->position) / 2;
  }

  /// Beyond the outermost picture on the sharper side; between two, where that is known to be
  /// behind; nothing where all is seen.
  std::optional<double> next_hop() const {
    const std::vector<Evaluation> all = hops();
    const auto [low, high] = around_sharpest(all, sides_.largest);
    const Evaluation& ahead = direction_ > 0 ? *high : *low;
    const double stride = model_.units(kStridePx);
    const Evaluation* beyond = nullptr;  // the next picture on that side
    for (const Evaluation& e : all) {
      if (direction_ * (e.position - ahead.position) <= 0) continue;
      if (beyond == nullptr || direction_ * (e.position - beyond->position) < 0) beyond = &e;
    }
    if (beyond != nullptr) {
      const double middle = (ahead.position + beyond->position) / 2;
      if (std::abs(beyond->position - ahead.position) < model_.units(2 * kCloserPx)) return {};
      return middle;
    }
    const double next = std::clamp(ahead.position + direction_ * stride, limits_.from, limits_.to);
    if (trace_.has(next)) return {};
    return next;
  }

  bool between_looks() const {
    const std::vector<Evaluation> all = hops();
    const auto [low, high] = around_sharpest(all, sides_.largest);
    const Evaluation& best = direction_ > 0 ? *high : *low;
    return std::any_of(all.begin(), all.end(),
                       [&](const Evaluation& e) { return e.position < best.position; }) &&
           std::any_of(all.begin(), all.end(),
                       [&](const Evaluation& e) { return e.position > best.position; });
  }

  /// Goes past the focus, six pictures, as often as it takes to be sure enough.
  /// Whether the focus is where it was said to be.
  bool pass() {
    const double wing = model_.units(kWingPx);
    const SpectralFit foretold = fit_;
    constexpr double kParts[] = {-1, -0.6, -0.2, 0.2, 0.6, 1};
    for (int passes = 0; passes < kMostPasses; ++passes) {
      const int way = way_to_pass(wing);
      const double shift = passes * wing * 0.1;  // the second time between the first ones' places
      for (const double part : kParts) {
        const double place = fit_.position + way * part * wing + shift;
        if (place < limits_.from - model_.units(kCloserPx) ||
            place > limits_.to + model_.units(kCloserPx) || is_seen(place, passes))
          continue;
        look(place);
        fit_ = fit_all(pictures(), here(), limits_);
        // From afar an object with relief is foretold a little aside; a false focus runs away.
        const double moved = std::abs(fit_.position - foretold.position);
        if (!is_sure(fit_) || (moved > wing && !is_same_place(foretold, fit_, model_)))
          return false;
      }
      if (!is_turning(wing)) return false;
      if (is_passed(wing) && is_precise()) break;
    }
    if (!is_passed(wing)) return false;
    if (!trace_.passed().empty()) trace_.remember(floor_of_way(trace_, fit_.position, model_));
    see_floor();
    see_slopes();
    return true;
  }

  /// Whether the coarsest rings are alike before and behind the focus. Where they go on rising or
  /// falling the lens is far from it, whatever the law makes of so few pictures.
  bool is_turning(double wing) const {
    const Evaluation* low = nullptr;
    const Evaluation* high = nullptr;
    for (const Evaluation& e : trace_.evaluations()) {
      if (std::abs(e.position - fit_.position) > 1.5 * wing) continue;
      if (low == nullptr || e.position < low->position) low = &e;
      if (high == nullptr || e.position > high->position) high = &e;
    }
    if (low == nullptr || low == high) return false;
    // What is left of the difference where both do not stand equally far.
    const double middle = (low->position + high->position) / 2;
    const double aside = std::abs(middle - fit_.position) / wing;
    const CoarseChange change = coarse_change(*low, *high, sides_.largest);
    constexpr double kSigmas = 5, kLeast = 0.02, kAside = 0.06;
    return std::abs(change.part) < std::max(kSigmas * change.sigma, kLeast + kAside * aside);
  }

  bool is_precise() const {
    const double wanted = 0.75 * limits_.tolerance;
    return fit_.sigma <= std::max(wanted, model_.units(kUnknownPx));
  }
  static constexpr double kUnknownPx = 0.1;  ///< What no number of pictures makes smaller.

  /// Upward where the lens comes from below or is nearer to the lower end of the pass.
  int way_to_pass(double wing) const {
    const double low = fit_.position - wing, high = fit_.position + wing;
    return std::abs(here() - low) <= std::abs(here() - high) ? 1 : -1;
  }

  bool is_seen(double place, int passes) const {
    const double near = passes == 0 ? model_.units(kCloserPx) / 2 : 0;
    return trace_.has(place) ||
           std::any_of(trace_.evaluations().begin(), trace_.evaluations().end(),
                       [&](const Evaluation& e) { return std::abs(e.position - place) < near; });
  }

  /// Whether pictures stand on both sides of the focus, near it.
  bool is_passed(double wing) const {
    const auto stands = [&](int side) {
      return std::any_of(trace_.evaluations().begin(), trace_.evaluations().end(),
                         [&](const Evaluation& e) {
                           const double away = side * (e.position - fit_.position);
                           return away > 0.2 * wing && away < 2.5 * wing;
                         });
    };
    return stands(-1) && stands(1);
  }

  /// A focus stands above what is far from it; somewhere that must have been seen.
  void see_floor() {
    const double far = model_.units(kFloorPx);
    for (const Evaluation& e : trace_.known()) {
      if (std::abs(e.position - fit_.position) >= 0.9 * far) return;
    }
    const int way = here() >= fit_.position ? 1 : -1;
    const double ahead = fit_.position + way * far, back = fit_.position - way * far;
    const bool fits = ahead >= limits_.from && ahead <= limits_.to;
    look(fits ? ahead : back);
  }

  /// A peak stands above both of its sides; that of a metric that sees coarse detail is wide.
  void see_slopes() {
    constexpr double kHigh = 0.75, kOutPx = 4;
    for (const int side : {here() >= fit_.position ? 1 : -1, here() >= fit_.position ? -1 : 1}) {
      const FocusCurve curve = trace_.curve();
      const Evaluation& outermost = side > 0 ? curve.back() : curve.front();
      if (outermost.score > curve.floor() + kHigh * curve.height())
        look(fit_.position + side * model_.units(kOutPx));
    }
  }

  SearchTrace& trace_;
  const FocusLimits& limits_;
  const BlurModel& model_;
  RingSides sides_;
  SpectralFit fit_;
  double last_ = 0;
  int direction_ = 1;
};

}  // namespace

const char* to_string(SpectralEnd end) noexcept {
  switch (end) {
    case SpectralEnd::found:
      return "found";
    case SpectralEnd::no_spectra:
      return "no-spectra";
    case SpectralEnd::nothing_changes:
      return "nothing-changes";
    case SpectralEnd::does_not_defocus:
      return "does-not-defocus";
    case SpectralEnd::beyond_travel:
      return "beyond-travel";
    case SpectralEnd::lost:
      return "lost";
  }
  return "unknown";
}

SpectralEnd spectral_search(SearchTrace& trace, const FocusLimits& limits) {
  return Walk(trace, limits).run();
}

bool pass_by_spectra(SearchTrace& trace, const FocusLimits& limits, double place) {
  return Walk(trace, limits).pass_near(place);
}

}  // namespace fathom
