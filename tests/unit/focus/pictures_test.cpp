// SPDX-License-Identifier: Apache-2.0
// What pictures tell beside their scores: light, noise, grey levels, parts, and a second look.
#include <gtest/gtest.h>

#include <cmath>

#include "focus/focus.hpp"

namespace fathom {
namespace {

const MetricSpec kWalsh = MetricSpec::standard(Transform::walsh_sequency, 64);
constexpr int kCount = 41;

/// A hill of height 1 and half width 4.
double bell(double position, double top) {
  const double z = (position - top) / 4;
  return std::exp(-std::log(2.0) * z * z);
}

/// A curve whose pictures are made by a formula, searched in full; a recording unless `is_live`.
Focus focus_of(const std::function<Sample(double)>& sample, bool is_live = false,
               double scatter = 0.005) {
  const LensInfo lens{"test lens", "steps", 0, kCount - 1, 1, 1, {}};
  FocusRequest request;
  request.search = SearchMethod::full;
  request.tolerance = 1;
  FocusLimits limits = resolve_limits(request, lens);
  limits.is_live = is_live;
  return search_focus({sample, [&](double p) { return nearest_position(lens, p); }}, limits, kWalsh,
                      scatter);
}

/// A picture of texture that comes into focus at `top`, beside noise of deviation 1.
PictureFacts texture(double position, double top) {
  const double contrast = 5 * bell(position, top);
  return {.brightness = 100,
          .light = 100,
          .deviation = std::hypot(1.0, contrast),
          .noise = std::hypot(1.0, 0.2 * contrast)};
}

double noise_score() { return white_noise_score(kWalsh); }

TEST(Pictures, OfTextureAreAFocus) {
  const Focus focus = focus_of(
      [](double p) { return Sample(noise_score() * (1 + 9 * bell(p, 20)), texture(p, 20)); });
  EXPECT_EQ(focus.result(), FocusResult::focused);
  EXPECT_NEAR(focus.position(), 20, 0.1);
}

TEST(Pictures, ThatBecomeNoisierAreNone) {
  const Focus focus = focus_of([](double p) {
    const double noise = 1 + 3 * bell(p, 20);
    return Sample(noise_score() * noise,
                  {.brightness = 100, .light = 100, .deviation = noise, .noise = noise});
  });
  EXPECT_EQ(focus.result(), FocusResult::no_focus);
  EXPECT_EQ(focus.verdict.reason.why, Why::noise_changed);
}

/// Fixed texture, equally sharp everywhere, in a lamp that swells by a fifth.
TEST(Pictures, ThatBecomeBrighterAreNone) {
  const Focus focus = focus_of([](double p) {
    const double light = 1 + 0.2 * bell(p, 20);
    return Sample(noise_score() + 30 * noise_score() * light,
                  {.brightness = 100 * light, .light = 100 * light, .deviation = 10, .noise = 1});
  });
  EXPECT_EQ(focus.result(), FocusResult::no_focus);
  EXPECT_EQ(focus.verdict.reason.why, Why::light_changed);
}

TEST(Pictures, TellWhereTheFocusIsInALampThatSwells) {
  const Focus focus = focus_of([](double p) {
    const double light = 1 + 0.3 * bell(p, 24);
    PictureFacts picture = texture(p, 20);
    picture.light *= light;
    return Sample(noise_score() * (1 + 9 * light * bell(p, 20)), picture);
  });
  EXPECT_EQ(focus.result(), FocusResult::focused);
  EXPECT_NEAR(focus.position(), 20, 0.1);
}

/// More than a lamp does, and no part of it is taken for one: the answer may be of either.
TEST(Pictures, OfAnExposureThatChangedHaveItInTheirSigma) {
  const auto exposed = [](double longer) {
    return [longer](double p) {
      const double exposure = p > 20 ? longer : 1;
      PictureFacts picture = texture(p, 20);
      picture.light *= exposure;
      return Sample(noise_score() * (1 + 9 * exposure * bell(p, 20)), picture);
    };
  };
  const Focus steady = focus_of(exposed(1)), changed = focus_of(exposed(3));
  const double error = std::abs(changed.position() - 20);
  ASSERT_EQ(changed.result(), FocusResult::focused);
  ASSERT_GT(error, 10 * steady.peak.sigma);
  EXPECT_LT(error, 1.5 * changed.peak.sigma);
  EXPECT_LT(changed.verdict.confidence, steady.verdict.confidence);
}

TEST(Pictures, OfLessThanAGreyLevelAreTooFaint) {
  const Focus focus = focus_of([](double p) {
    const double part = 0.4 * bell(p, 20);
    return Sample(0.1 + bell(p, 20), {.brightness = 4,
                                      .light = 4,
                                      .deviation = std::hypot(0.1, part),
                                      .noise = std::hypot(0.1, 0.2 * part)});
  });
  EXPECT_EQ(focus.verdict.reason.why, Why::too_faint);
}

/// Left parts of the window are sharp at 10, right ones at `right`; between them is nothing.
Focus focus_of_two(double right) {
  return focus_of([right](double p) {
    PictureFacts picture = texture(p, right);
    const double tops[kPartsAcross] = {bell(p, 10), 0, bell(p, right)};
    double sum = 0;
    for (std::size_t i = 0; i < kParts; ++i) {
      const double score = tops[i % kPartsAcross];
      picture.parts[i] = noise_score() * (1 + 9 * score);
      sum += score / kParts;
    }
    return Sample(noise_score() * (1 + 9 * sum), picture);
  });
}

/// Fixed texture in the left and, coming into focus at 20, in the middle of a window; a lamp that
/// swells by a third at 12 reaches the left alone.
Focus focus_beside_a_lamp(double sharp) {
  return focus_of([sharp](double p) {
    const double lamp = 1 + 0.3 * bell(p, 12);
    PictureFacts picture = texture(p, 20);
    double sum = 0;
    for (std::size_t i = 0; i < kParts; ++i) {
      const std::size_t column = i % kPartsAcross;
      const double light = column == 0 ? lamp : 1;
      picture.part_brightness[i] = 100 * light;
      picture.parts[i] = noise_score() * (30 * light + (column == 1 ? sharp * bell(p, 20) : 0));
      sum += picture.parts[i] / kParts;
    }
    return Sample(sum, picture);
  });
}

TEST(Parts, ThatALampReachesAloneAreNoFocus) {
  const Focus lamp = focus_beside_a_lamp(0);
  EXPECT_EQ(lamp.result(), FocusResult::no_focus);
  EXPECT_EQ(lamp.verdict.reason.why, Why::light_in_part);
  const Focus clear = focus_beside_a_lamp(200);
  EXPECT_EQ(clear.result(), FocusResult::focused);
  EXPECT_NEAR(clear.position(), 20, 0.2);
  EXPECT_EQ(clear.verdict.reason.light_left, 1);
}

/// The edge of a light that comes and goes: no part's score goes with its brightness, but the
/// pixels vary because the parts differ.
TEST(Parts, ThatALightDividesAreDoubted) {
  for (const double light : {0.0, 0.2}) {
    const Focus focus = focus_of([light](double p) {
      const double step = 100 * light * bell(p, 20);
      PictureFacts picture = texture(p, 20);
      picture.deviation = std::hypot(picture.deviation, step / 2);
      for (std::size_t i = 0; i < kParts; ++i) {
        picture.part_brightness[i] = 100 + step * (1 - static_cast<double>(i % kPartsAcross)) / 2;
        picture.parts[i] = noise_score() * (1 + 9 * bell(p, 20));
      }
      return Sample(noise_score() * (1 + 9 * bell(p, 20)), picture);
    });
    EXPECT_EQ(focus.result(), FocusResult::focused);
    EXPECT_EQ(focus.verdict.reason.light_left, light > 0 ? PartLight::kEdge : 1);
    EXPECT_EQ(focus.verdict.confidence<0.5, light> 0);
  }
}

/// Noise alone, whose scores happen to go with the brightness of its left parts.
TEST(Parts, OfACardWithoutAnyRiseTellOfNoLight) {
  const Focus focus = focus_of([](double p) {
    const double chance = 0.01 * std::sin(2.4 * p);
    PictureFacts picture = {.brightness = 100, .light = 100, .deviation = 1, .noise = 1};
    for (std::size_t i = 0; i < kParts; ++i) {
      picture.part_brightness[i] = 100 + (i % kPartsAcross == 0 ? chance : 0);
      picture.parts[i] = noise_score() * (1 + chance);
    }
    return Sample(noise_score() * (1 + chance), picture);
  });
  EXPECT_EQ(focus.verdict.reason.why, Why::within_noise);
  EXPECT_EQ(focus.verdict.reason.light_left, 1);
}

TEST(Parts, OfOneDepthAddNothingToSigma) {
  const Focus focus = focus_of_two(10);
  EXPECT_EQ(focus.result(), FocusResult::focused);
  EXPECT_EQ(focus.depths.parts.size(), 6u);
  EXPECT_EQ(focus.depths.spread, 0);
}

TEST(Parts, OfASlopeAreInSigma) {
  const Focus focus = focus_of_two(13);
  EXPECT_EQ(focus.result(), FocusResult::focused);
  EXPECT_GT(focus.depths.spread, 0.7);
  EXPECT_GE(focus.peak.sigma, focus.depths.spread);
}

TEST(Parts, OfTwoDepthsAreAmbiguousWithBoth) {
  const Focus focus = focus_of_two(17);
  EXPECT_EQ(focus.result(), FocusResult::ambiguous);
  const Reason& reason = focus.verdict.reason;
  EXPECT_EQ(reason.why, Why::two_depths);
  EXPECT_NEAR(std::min(reason.position, reason.second_position), 10, 0.5);
  EXPECT_NEAR(std::max(reason.position, reason.second_position), 17, 0.5);
}

/// The scene moves by `shift` once the search is over.
Focus focus_of_moved(double shift) {
  int looks = 0;
  return focus_of(
      [&looks, shift](double p) {
        const double top = ++looks > kCount ? 20 + shift : 20;
        return Sample(1 + 9 * bell(p, top), texture(p, top));
      },
      true, 0.002);
}

TEST(SecondLook, AgreesWithASceneThatStands) {
  const Focus focus = focus_of_moved(0);
  EXPECT_EQ(focus.result(), FocusResult::focused);
  EXPECT_EQ(focus.second_looks.size(), 3u);
}

TEST(SecondLook, SeesASceneThatMoved) {
  for (const double shift : {-3.0, -0.7, 0.7, 3.0}) {
    const Focus focus = focus_of_moved(shift);
    EXPECT_EQ(focus.result(), FocusResult::no_focus) << shift;
    EXPECT_EQ(focus.verdict.reason.why, Why::changed) << shift;
  }
}

TEST(SecondLook, AsksNothingOfARecording) {
  EXPECT_TRUE(focus_of([](double p) {
                return Sample(1 + 9 * bell(p, 20), texture(p, 20));
              }).second_looks.empty());
}

/// A slope has its best score at an end, and noise may lift a neighbour above it.
TEST(Ends, AMaximumThatDoesNotStandAboveBothIsAtTheLimit) {
  const Focus focus =
      focus_of([](double p) { return Sample(1 + 0.05 * p + (p == kCount - 2 ? 0.06 : 0.0)); });
  EXPECT_EQ(focus.result(), FocusResult::at_limit);
  EXPECT_TRUE(focus.verdict.reason.at_lens_end);
}

TEST(Losses, MakeAFocusLessSure) {
  Focus focus = focus_of([](double p) { return Sample(1 + 9 * bell(p, 20), texture(p, 20)); });
  const double sure = focus.verdict.confidence, sigma = focus.peak.sigma;
  doubt_for_losses(focus, 0.5);
  EXPECT_DOUBLE_EQ(focus.verdict.confidence, sure / 2);
  EXPECT_DOUBLE_EQ(focus.peak.sigma, sigma * std::sqrt(2.0));
}

}  // namespace
}  // namespace fathom
