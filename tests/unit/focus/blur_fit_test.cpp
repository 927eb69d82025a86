// SPDX-License-Identifier: Apache-2.0
// Blur models learned from ring powers that the law itself makes, and what is refused.
#include "focus/blur_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace fathom {
namespace {

constexpr int kSide = 64;

/// An object of random powers that fall with frequency, as of natural texture, seen through a lens.
class Scene {
 public:
  Scene(unsigned seed, const BlurModel& lens) : random_(seed), lens_(lens) {
    std::lognormal_distribution<double> texture(0, 0.7);
    const int rings = law().rings();
    for (int k = 0; k < rings; ++k) {
      const double cycles = k + 0.5;
      object_.push_back(3000 * kNoise * texture(random_) / (cycles * cycles));
    }
  }

  std::vector<Evaluation> pictures(const std::vector<double>& positions, double focus) {
    std::vector<Evaluation> all;
    for (const double position : positions) {
      all.push_back({static_cast<int>(all.size()) + 1, position, 1});
      all.back().picture.rings = {{kSide, powers(position - focus)}};
    }
    return all;
  }

 private:
  static constexpr double kNoise = 0.01;

  const DefocusLaw& law() const { return DefocusLaw::of(kSide, lens_.shape); }

  std::vector<float> powers(double from_focus) {
    const int rings = law().rings();
    std::vector<float> squared(rings), slope(rings), made;
    law().transfer(lens_.diameter_px(from_focus), squared, slope);
    for (int k = 0; k < rings; ++k) {
      const double signal = object_[k] * squared[k];
      // Of a signal that stays, in noise of one grade of freedom for every pair of coefficients.
      const double freedom = law().counts()[k] / 1.5 / 2;
      const double scatter = std::sqrt((kNoise * kNoise + 2 * kNoise * signal) / freedom);
      std::normal_distribution<double> error(0, scatter);
      made.push_back(static_cast<float>(std::max(0.0, signal + kNoise + error(random_))));
    }
    return made;
  }

  std::mt19937 random_;
  BlurModel lens_;
  std::vector<double> object_;
};

std::vector<double> every(double step, double from, double to) {
  std::vector<double> positions;
  for (double position = from; position <= to; position += step) positions.push_back(position);
  return positions;
}

TEST(BlurFit, GivesBackTheLensThatMadeThePictures) {
  for (const double kappa : {0.02, 0.0824, 0.5, 3.0}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      Scene scene(seed, {.px_per_unit = kappa, .rest_px = 0.9});
      const double focus = 300 + 0.37 * seed / kappa;
      const auto positions = every(0.9 / kappa, focus - 11.3 / kappa, focus + 9.1 / kappa);
      const auto fit = fit_blur(scene.pictures(positions, focus));
      ASSERT_TRUE(fit) << "kappa " << kappa << ", seed " << seed;
      EXPECT_NEAR(fit->model.px_per_unit / kappa, 1, 0.05)
          << "kappa " << kappa << ", seed " << seed;
      EXPECT_NEAR((fit->position - focus) * kappa, 0, 0.1);
      EXPECT_LT(fit->model.uncertainty, 0.1);
      EXPECT_LT(fit->misfit, 1.2);
    }
  }
}

TEST(BlurFit, FindsTheRestOfTheBlur) {
  Scene scene(7, {.px_per_unit = 0.1, .rest_px = 3});
  const auto fit = fit_blur(scene.pictures(every(8, 400, 600), 503), {.focus = 500});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->model.px_per_unit, 0.1, 0.01);
  EXPECT_NEAR(fit->model.rest_px, 3, 0.6);
}

TEST(BlurFit, TellsAGaussianFromADisc) {
  for (const BlurShape shape : {BlurShape::disc, BlurShape::gaussian}) {
    Scene scene(11, {.px_per_unit = 0.1, .shape = shape});
    const auto fit = fit_blur(scene.pictures(every(6, 440, 560), 503), {.focus = 500});
    ASSERT_TRUE(fit) << to_string(shape);
    EXPECT_EQ(fit->model.shape, shape);
    EXPECT_NEAR(fit->model.px_per_unit, 0.1, 0.007);
  }
}

/// A crowd of pictures fits a fast blur; those far away, still sharp, belie it.
TEST(BlurFit, IsBelievedOnlyIfWhatIsFarIsBlurred) {
  constexpr double kFocus = 500, kFar = 300;
  for (const bool is_blurred : {true, false}) {
    Scene scene(5, {.px_per_unit = 0.3});
    auto pictures = scene.pictures(every(3, 480, 520), kFocus);
    for (const int side : {-1, 1}) {
      auto far = scene.pictures({kFocus + side * (is_blurred ? kFar : 10)}, kFocus);
      far[0].position = kFocus + side * kFar;
      pictures.push_back(far[0]);
    }
    EXPECT_EQ(fit_blur(pictures, {.focus = kFocus}).has_value(), is_blurred);
  }
}

TEST(BlurFit, IsAsUncertainAsItSays) {
  double squares = 0;
  constexpr int kSeeds = 40;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Scene scene(100 + seed, {.px_per_unit = 0.1});
    const auto fit = fit_blur(scene.pictures({455, 480, 498, 521, 540}, 503), {.focus = 500});
    ASSERT_TRUE(fit) << seed;
    const double error = std::log(fit->model.px_per_unit / 0.1) / fit->model.uncertainty;
    squares += error * error;
  }
  // The part that stands for errors of the law is more than these pictures need.
  EXPECT_LT(std::sqrt(squares / kSeeds), 1.2);
  EXPECT_GT(std::sqrt(squares / kSeeds), 0.1);
}

TEST(BlurFit, RefusesALensThatChangesNothing) {
  Scene scene(3, {.px_per_unit = 1e-9});
  EXPECT_FALSE(fit_blur(scene.pictures(every(10, 400, 600), 500)));
  EXPECT_FALSE(fit_blur(scene.pictures(every(10, 400, 600), 500), {.focus = 500}));
}

TEST(BlurFit, RefusesPicturesOfOnePlaceAndOfOneSide) {
  Scene scene(4, {.px_per_unit = 0.1});
  EXPECT_FALSE(fit_blur({}));
  EXPECT_FALSE(fit_blur(scene.pictures({500, 500, 500, 500, 500, 500}, 520)));
  EXPECT_FALSE(fit_blur(scene.pictures({480, 520, 540}, 500)));
  EXPECT_FALSE(fit_blur(scene.pictures(every(8, 400, 600), 395)));
  EXPECT_FALSE(fit_blur(scene.pictures(every(8, 400, 600), 604), {.focus = 600}));
}

TEST(BlurFit, RefusesPicturesThatNoLensMakes) {
  Scene scene(5, {.px_per_unit = 0.1});
  std::vector<Evaluation> all = scene.pictures(every(8, 400, 600), 500);
  // Another object in every picture: no two rings rise and fall together.
  std::mt19937 random(9);
  std::lognormal_distribution<float> other(0, 1);
  for (Evaluation& e : all) {
    for (float& power : e.picture.rings[0].powers) power *= other(random);
  }
  EXPECT_FALSE(fit_blur(all));
  EXPECT_FALSE(fit_blur(all, {.focus = 500}));
}

TEST(BlurFit, DoubtsAModelThatIsWrongByTwoAndNoOther) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Scene scene(seed, {.px_per_unit = 0.1});
    const auto all = scene.pictures({440, 470, 485, 493, 501, 509, 518, 545}, 502);
    EXPECT_FALSE(is_doubtful(all, {.px_per_unit = 0.1}, 502)) << seed;
    EXPECT_FALSE(is_doubtful(all, {.px_per_unit = 0.12}, 502)) << seed;
    EXPECT_TRUE(is_doubtful(all, {.px_per_unit = 0.2}, 502)) << seed;
    EXPECT_TRUE(is_doubtful(all, {.px_per_unit = 0.05}, 502)) << seed;
  }
}

TEST(BlurModel, AgreesWithinWhatIsNotKnown) {
  const BlurModel model{.px_per_unit = 0.1};
  EXPECT_TRUE(agree(model, {.px_per_unit = 0.14}));
  EXPECT_FALSE(agree(model, {.px_per_unit = 0.2}));
  EXPECT_FALSE(agree(model, {.px_per_unit = 0.05}));
  EXPECT_TRUE(agree(model, {.px_per_unit = 0.2, .uncertainty = 0.3}));
}

}  // namespace
}  // namespace fathom
