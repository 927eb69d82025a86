// SPDX-License-Identifier: Apache-2.0
// Claims on the focus curves: chapters VI and VII.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/fathom/reproduce/claims.hpp"

namespace fathom::reproduce {
namespace {

Claim peak_at_best_focus(const Curves& curves) {
  constexpr double kNear = 3;  // steps; a quarter of half of the depth of field
  double farthest = 0;
  for (const MeasuredCurves& curve : curves.curves) {
    for (const double best : curve.best)
      farthest = std::max(farthest, std::abs(best - curve.truth));
  }
  return {"peak-at-best-focus",
          "The score is highest at best focus, for all three transforms",
          "p. 62, figs. 11\u201313",
          "always, by eye",
          fmt::format("{} curves, all within {:.1f} steps of the true focus",
                      curves.curves.size() * kTransformCount, farthest),
          holds_if(farthest < kNear),
          "curves"};
}

Claim one_peak(const Curves& curves) {
  std::size_t single = 0, all = 0;
  for (const MeasuredCurves& curve : curves.curves) {
    for (const std::size_t lobes : curve.lobes) {
      ++all;
      if (lobes == 1) ++single;
    }
  }
  return {"one-peak",
          "A focus quality function should have one peak only",
          "p. 61, figs. 11\u201313",
          "seen in the plots",
          fmt::format("one peak that stands out of the noise in {} of {} curves", single, all),
          holds_if(single == all, Mark::partly),
          "curves"};
}

Claim nearly_identical(const Results& results) {
  double apart = 0;
  for (const MeasuredCurves& curve : results.curves.curves) {
    const auto [low, high] = std::minmax_element(curve.fitted.begin(), curve.fitted.end());
    apart = std::max(apart, *high - *low);
  }
  return {"nearly-identical",
          "The three transforms find nearly the same focus",
          "p. 90, table II",
          "means within 17 mm",
          fmt::format("fitted peaks within {:.2f} step of each other", apart),
          holds_if(apart <= 1),
          "curves"};
}

std::string text_of(const Ratio& ratio) {
  return fmt::format("{:.1f}\u00D7 ({:.1f} to {:.1f})", ratio.value, ratio.low, ratio.high);
}

Claim steadier_far_from_focus(const Curves& curves) {
  return {"walsh-steadier",
          "Far from focus the FFT fluctuates more than Walsh",
          "p. 90",
          "seen, not measured",
          "FFT rougher than normal Walsh " + text_of(curves.paley_of_peak) +
              ", than sequency Walsh " + text_of(curves.sequency_of_peak),
          holds_if(curves.paley_of_peak.low > 1 && curves.sequency_of_peak.low > 1),
          "far"};
}

Claim better_when_defocused(const Searches& searches) {
  const auto lost = [&](std::size_t t) { return searches.bare[t].wrong; };
  const bool less = lost(kFft) > std::max(lost(kPaley), lost(kSequency));
  return {
      "walsh-better-defocused",
      "Walsh works better than the FFT when the lens is grossly out of focus",
      "p. 90",
      "seen, not measured",
      fmt::format("golden section over the whole travel got lost in {} (FFT), {} and {} (Walsh) "
                  "of {} runs each",
                  lost(kFft), lost(kPaley), lost(kSequency), searches.bare[kFft].runs.size()),
      holds_if(less, lost(kFft) == 0 ? Mark::partly : Mark::fails),
      "far"};
}

double worst(const Repeatability& repeatability, int average) {
  double most = 0;
  for (std::size_t t = 0; t < kTransformCount; ++t) {
    most = std::max(most, repeatability.worst_half_range(t, average));
  }
  return most;
}

void add_repeatability(const Repeatability& repeatability, std::vector<Claim>& claims) {
  const double one = worst(repeatability, 1), ten = worst(repeatability, kManyFrames);
  claims.push_back({"repeats-within-2-percent",
                    "In focus, the score of one frame repeats within 2 %", "p. 58", "\u00B12 %",
                    plus_minus(one) + " at worst", holds_if(one < 0.02), "repeatability"});
  claims.push_back({"ten-frames-1.5-percent", "The mean of ten frames repeats within 1.5 %",
                    "p. 58", "\u00B12 to \u00B11.5 %",
                    fmt::format("\u00B1{:.2f} to {}", 100 * one, plus_minus(ten)),
                    holds_if(ten < 0.015 && ten < one), "repeatability"});
  double least = 1, most = 0;
  for (const double distance : kCurveDistances) {
    const double part = repeatability.find(distance, false, 1).of(kFft).half_range_part();
    least = std::min(least, part);
    most = std::max(most, part);
  }
  claims.push_back({"repeats-alike-at-all-distances", "It varies alike at all distances", "p. 58",
                    "essentially the same",
                    fmt::format("\u00B1{:.2f} to {} (FFT)", 100 * least, plus_minus(most)),
                    holds_if(most < 1.5 * least, Mark::partly), "repeatability"});
}

}  // namespace

void add_claims_on_curves(const Results& results, std::vector<Claim>& claims) {
  claims.push_back(peak_at_best_focus(results.curves));
  claims.push_back(one_peak(results.curves));
  claims.push_back(nearly_identical(results));
  claims.push_back(steadier_far_from_focus(results.curves));
  claims.push_back(better_when_defocused(results.searches));
  add_repeatability(results.repeatability, claims);
}

}  // namespace fathom::reproduce
