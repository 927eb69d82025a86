// SPDX-License-Identifier: Apache-2.0
#include "focus/first_look.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "focus/focus.hpp"
#include "focus/patch_relief.hpp"

namespace fathom {
namespace {

constexpr double kLeastBlurPx = 4;  ///< Less is no blur to compare.
constexpr double kLargestBlur = 9;  ///< Of the reduced pictures: finer pixels tell nothing more.
constexpr int kShift = 1;           ///< Of the reduced pictures.

int reduction_of(double blur_px) { return std::max(1, static_cast<int>(blur_px / kLargestBlur)); }

/// Means of squares of f x f pixels; what is left at the right and below is dropped.
Patch reduced(const Patch& patch, int f) {
  Patch small{patch.width / f, patch.height / f, {}};
  small.greys.assign(static_cast<std::size_t>(small.width) * small.height, 0);
  for (int y = 0; y < small.height * f; ++y) {
    const float* const row = patch.greys.data() + static_cast<std::size_t>(y) * patch.width;
    float* const to = small.greys.data() + static_cast<std::size_t>(y / f) * small.width;
    for (int x = 0; x < small.width * f; ++x) to[x / f] += row[x];
  }
  for (float& grey : small.greys) grey /= static_cast<float>(f * f);
  return small;
}

/// A stripe of a blur's weights: all pixels of a row within so much of the middle.
struct Stripe {
  int row = 0;      ///< From the middle's.
  double half = 0;  ///< Length from the middle to either end, px.
  double weight = 0;
};

/// A disc in stripes of a row each; a small one in thinner ones.
void add_disc(std::vector<Stripe>& stripes, double radius, double weight) {
  constexpr double kLarge = 4;
  const int in_row = radius < kLarge ? 4 : 1;
  const int rows = static_cast<int>(std::ceil(radius));
  const auto first = static_cast<std::ptrdiff_t>(stripes.size());
  double area = 0;
  for (int i = -rows * in_row; i < (rows + 1) * in_row; ++i) {
    const int row = (i + rows * in_row) / in_row - rows;
    const double y = (i + 0.5) / in_row - 0.5;
    if (std::abs(y) >= radius) continue;
    const double half = std::sqrt(radius * radius - y * y);
    stripes.push_back({row, half, 0});
    area += 2 * half;
  }
  for (auto s = stripes.begin() + first; s != stripes.end(); ++s) s->weight = weight / area;
}

/// A Gaussian of the same second moment is a mean of discs: as many of each squared radius as
/// exp(-r^2 / (2 sigma^2)) falls there.
std::vector<Stripe> stripes_of(BlurShape shape, double diameter) {
  std::vector<Stripe> stripes;
  switch (shape) {
    case BlurShape::disc:
      add_disc(stripes, diameter / 2, 1);
      break;
    case BlurShape::gaussian: {
      // A disc of radius r counts with t exp(-t) dt, t = r^2 / (2 sigma^2).
      constexpr double kTimes[] = {0.25, 0.75, 1.25, 1.75, 2.25, 2.75, 3.5, 4.5, 6};
      constexpr double kLengths[] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1, 1, 2};
      const double sigma = diameter / 4;
      for (std::size_t i = 0; i < std::size(kTimes); ++i)
        add_disc(stripes, sigma * std::sqrt(2 * kTimes[i]),
                 kTimes[i] * std::exp(-kTimes[i]) * kLengths[i]);
      break;
    }
  }
  return stripes;
}

/// Sums along rows up to each pixel; beyond either end a row goes on with nothing.
class RowSums {
 public:
  /// pad: so many pixels beyond an end may be asked for.
  RowSums(const Patch& patch, int pad)
      : height_(patch.height), pad_(pad), line_(patch.width + 1 + 2 * pad) {
    sums_.reserve(static_cast<std::size_t>(line_) * height_);
    const float* grey = patch.greys.data();
    for (int y = 0; y < height_; ++y) {
      double sum = 0;
      sums_.insert(sums_.end(), static_cast<std::size_t>(pad + 1), 0);
      for (int x = 0; x < patch.width; ++x) sums_.push_back(static_cast<float>(sum += *grey++));
      sums_.insert(sums_.end(), static_cast<std::size_t>(pad), static_cast<float>(sum));
    }
  }

  int height() const { return height_; }

  /// Adds to each of so many pixels the weighted sum of what is within `half` of its middle in this
  /// row: the first one's middle lies at `middle`, the next ones' a pixel further each.
  void add(int row, double middle, double half, double weight, std::span<float> to) const {
    const double low = middle - std::min(half, pad_ - 1.0);
    const double high = middle + std::min(half, pad_ - 1.0);
    const double whole_low = std::floor(low), whole_high = std::floor(high);
    const float* const line = sums_.data() + static_cast<std::size_t>(row) * line_ + pad_;
    const float* const l = line + static_cast<std::ptrdiff_t>(whole_low);
    const float* const h = line + static_cast<std::ptrdiff_t>(whole_high);
    const auto l1 = static_cast<float>(weight * (low - whole_low));
    const auto h1 = static_cast<float>(weight * (high - whole_high));
    const float all = static_cast<float>(weight), l0 = all - l1, h0 = all - h1;
    for (std::size_t x = 0; x < to.size(); ++x)
      to[x] += (h0 * h[x] + h1 * h[x + 1]) - (l0 * l[x] + l1 * l[x + 1]);
  }

 private:
  int height_, pad_, line_;
  std::vector<float> sums_;  ///< Of what differs from the mean: few digits are enough.
};

/// The sharp picture blurred, where the first one is and kShift beyond it.
Patch blurred(const RowSums& sharp, int margin, const Patch& first, std::span<const Stripe> disc) {
  Patch result{first.width + 2 * kShift, first.height + 2 * kShift, {}};
  result.greys.assign(static_cast<std::size_t>(result.width) * result.height, 0);
  const int from = margin - kShift;
  const auto line = static_cast<std::size_t>(result.width);
  for (int y = 0; y < result.height; ++y) {
    const std::span<float> row = std::span(result.greys).subspan(y * line, line);
    for (const Stripe& s : disc) {
      const int there = std::clamp(y + from + s.row, 0, sharp.height() - 1);
      sharp.add(there, from + 0.5, s.half, s.weight, row);
    }
  }
  return result;
}

/// Of the sharp picture with each blur that is tried.
class Comparison {
 public:
  Comparison(const Patch& sharp, const Patch& first, const FirstLookPlan& plan)
      : plan_(plan),
        f_(reduction_of(plan.foretold_px)),
        first_(reduced(first, f_)),
        relief_(first_),
        margin_(plan.margin_px / f_),
        // Both begin at the same pixel of a square.
        sharp_(centred(reduced(without(sharp, plan.margin_px % f_), f_)), pad_of(plan, f_)) {}

  bool can_compare() const {
    constexpr int kFewest = 6;
    return std::min(first_.width, first_.height) >= kFewest && margin_ > kShift;
  }

  double points() const { return static_cast<double>(first_.greys.size()); }

  double left(double diameter_px) const {
    // Sums of whole pixels blur by such a pixel too, whose second moment is that of a disc of 4/3.
    const double pixel_px = std::sqrt(4 / 3.0) * f_;
    const double squared = diameter_px * diameter_px - plan_.sharp_px * plan_.sharp_px;
    const double added = std::sqrt(std::max(0.0, squared - pixel_px * pixel_px));
    const auto stripes = stripes_of(plan_.shape, std::max(added / f_, 0.05));
    const Patch foretold = blurred(sharp_, margin_, first_, stripes);
    double least = 1;
    for (int dy = -kShift; dy <= kShift; ++dy) {
      for (int dx = -kShift; dx <= kShift; ++dx)
        least = std::min(least, relief_.left_by(foretold, kShift + dx, kShift + dy));
    }
    return least;
  }

 private:
  /// Without so many rows and columns at each end.
  static Patch without(const Patch& patch, int cut) {
    if (cut == 0) return patch;
    Patch rest{patch.width - 2 * cut, patch.height - 2 * cut, {}};
    for (int y = cut; y < patch.height - cut; ++y) {
      const auto row = patch.greys.begin() + static_cast<std::ptrdiff_t>(y) * patch.width;
      rest.greys.insert(rest.greys.end(), row + cut, row + patch.width - cut);
    }
    return rest;
  }

  /// A Gaussian of the widest blur reaches so far, and somewhat more is tried.
  static int pad_of(const FirstLookPlan& plan, int f) {
    return static_cast<int>(1.2 * widest_tried(plan.foretold_px) / f) + 4;
  }

  FirstLookPlan plan_;
  int f_;
  Patch first_;
  PatchRelief relief_;
  int margin_;
  RowSums sharp_;
};

}  // namespace

int telling_side(double foretold_px) {
  constexpr int kReduced = 56;
  return kReduced * reduction_of(foretold_px);
}

double widest_tried(double foretold_px) {
  constexpr double kHighest = 1.6, kAbove = 4;
  return kHighest * foretold_px + kAbove;
}

namespace {

/// The blurs that were tried, and which of them explain most.
class Trial {
 public:
  Trial(const Comparison& comparison, const FirstLookPlan& plan)
      : comparison_(comparison), plan_(plan), look_{.foretold_px = plan.foretold_px} {}

  /// What law and the other picture allow, and the ends of that.
  void attempt_foretold() {
    constexpr double kInside = 0.999;
    foretold_left_ = attempt(plan_.foretold_px);
    for (const double side : {-kInside, kInside}) {
      attempt(plan_.foretold_px + side * plan_.doubt_px);
      if (plan_.beside_px) attempt(plan_.foretold_px + side * *plan_.beside_px);
    }
  }

  /// Others on either side, until they explain less and less; and round the best of all more
  /// closely, where that is none that was foretold.
  void attempt_others() {
    constexpr double kStep = 0.12, kLeastStep = 1;
    constexpr int kHalvings = 3;
    double step = std::max(kLeastStep, kStep * plan_.foretold_px);
    for (const int side : {-1, 1}) attempt_towards(side * step);
    const bool is_foretold = std::abs(look_.seen_px - plan_.foretold_px) <= plan_.doubt_px;
    if (is_foretold && !plan_.is_exact) return;
    for (int i = 0; i < kHalvings; ++i) {
      step /= 2;
      const double middle = look_.seen_px;
      attempt(middle - step);
      attempt(middle + step);
    }
  }

  std::optional<FirstLook> end() const {
    if (!(look_.unexplained > 0 && look_.unexplained < 1)) return std::nullopt;
    FirstLook look = look_;
    look.evidence = comparison_.points() * std::log(by_law_ / look.unexplained);
    if (plan_.beside_px)
      look.evidence_beside = comparison_.points() * std::log(by_beside_ / look.unexplained);
    return look;
  }

 private:
  void attempt_towards(double step) {
    constexpr double kLowest = 0.4, kBelow = 3;
    constexpr int kWorse = 3;  // one after the other: blurs ever less like the picture's
    const double lowest = std::max(plan_.sharp_px, kLowest * plan_.foretold_px - kBelow);
    double before = foretold_left_;
    int worse = 0;
    for (double d = plan_.foretold_px + step;
         d >= lowest && d <= widest_tried(plan_.foretold_px) && worse < kWorse; d += step) {
      const double left = attempt(d);
      worse = left > before ? worse + 1 : 0;
      before = left;
    }
  }

  /// What such a blur leaves.
  double attempt(double diameter_px) {
    const double left = comparison_.left(diameter_px);
    const double away = std::abs(diameter_px - plan_.foretold_px);
    if (away <= plan_.doubt_px) by_law_ = std::min(by_law_, left);
    if (plan_.beside_px && away <= *plan_.beside_px) by_beside_ = std::min(by_beside_, left);
    if (left < look_.unexplained) {
      look_.unexplained = left;
      look_.seen_px = diameter_px;
    }
    return left;
  }

  const Comparison& comparison_;
  const FirstLookPlan& plan_;
  FirstLook look_;
  double by_law_ = 1, by_beside_ = 1;
  double foretold_left_ = 1;
};

}  // namespace

std::optional<FirstLook> look_at_first(const Patch& sharp, const Patch& first,
                                       const FirstLookPlan& plan) {
  if (plan.foretold_px < std::max(kLeastBlurPx, 2 * plan.sharp_px)) return std::nullopt;
  const Comparison comparison(sharp, first, plan);
  if (!comparison.can_compare()) return std::nullopt;
  Trial trial(comparison, plan);
  trial.attempt_foretold();
  trial.attempt_others();
  return trial.end();
}

namespace {
// The largest evidence beside of 200 undisturbed searches was 54, of an orange (fathom_honesty).
constexpr double kEvidence = 80;
}  // namespace

bool is_striking(const FirstLook& look) { return look.evidence > kEvidence; }

bool contradicts(const FirstLook& look) {
  constexpr double kExplains = 0.1, kStriking = 600, kOther = 0.25;
  if (look.unexplained > kExplains) return false;
  const bool is_other = std::abs(look.seen_px / look.foretold_px - 1) > kOther;
  return look.evidence_beside > kEvidence || (look.evidence > kStriking && is_other);
}

void doubt_for_first_look(Focus& focus, const std::optional<FirstLook>& look,
                          double first_position) {
  focus.first_look = look;
  if (!look || focus.result() != FocusResult::focused || !contradicts(*look)) return;
  focus.verdict.result = FocusResult::no_focus;
  focus.verdict.confidence = 0;
  focus.verdict.reason.why = Why::changed;
  focus.verdict.reason.position = first_position;
}

}  // namespace fathom
