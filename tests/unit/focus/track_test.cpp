// SPDX-License-Identifier: Apache-2.0
#include "focus/track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fathom {
namespace {

const MetricSpec kFft = MetricSpec::standard(Transform::fft, 64);
const LensInfo kLens{"test lens", "steps", 0, 1200, 1, 100, {}};
constexpr double kFloor = 0.16, kHeight = 0.84, kHalfWidth = 22;
constexpr double kNoise = 0.004;  // of the floor

/// A target that moves evenly, before a lens of 25 steps a second.
class MovingScene {
 public:
  MovingScene(double peak, double speed, unsigned seed) : peak_(peak), speed_(speed) {
    random_.seed(seed);
  }

  TimedObjective timed() {
    return {{[this](double p) { return look(p); }, [](double p) { return std::round(p); }},
            [this] { return time_s_; }};
  }
  double peak() const { return peak_ + speed_ * time_s_; }
  std::vector<Sighting> seen;
  bool is_there = true;
  double saturated = 0;  ///< Part of every picture's pixels.

 private:
  Sample look(double position) {
    time_s_ += 0.1 + std::abs(position - lens_) / 25;
    lens_ = position;
    const double z = (position - peak()) / kHalfWidth;
    // Twelve even numbers make a normal one.
    double noise = -6;
    for (int i = 0; i < 12; ++i) noise += static_cast<double>(random_()) / 4294967296.0;
    const double height = is_there ? kHeight : 0;
    const double score = kFloor + height / (1 + z * z) + noise * kNoise * kFloor;
    seen.push_back({position, score, time_s_});
    return Sample(score, {.saturated = saturated});
  }

  std::mt19937 random_;
  double peak_, speed_, lens_ = 0, time_s_ = 0;
};

FocusLimits limits() {
  FocusLimits all = resolve_limits({}, kLens);
  return all;
}

/// A focus as a search of a scene that stood still would have left it.
Focus focus_at(double position) {
  Focus focus;
  focus.verdict.result = FocusResult::focused;
  focus.floor = kFloor;
  focus.peak = {.shape = PeakShape::lorentzian,
                .position = position,
                .sigma = 0.2,
                .score = kFloor + kHeight,
                .half_width = kHalfWidth,
                .r_squared = 1,
                .points = 6,
                .parameters = 3};
  focus.lobes = {focus.peak};
  for (double p = 0; p <= 1200; p += 200) focus.background.push_back({1, p, kFloor});
  return focus;
}

/// What is told of a peak that starts at 600, after some looks round where it is.
Focus tracked(MovingScene& scene) {
  const TimedObjective timed = scene.timed();
  for (const double beside : {-15, 15, 0}) timed.objective.score(std::round(scene.peak() + beside));
  const std::vector<Sighting> seen = scene.seen;
  return track_focus(timed, limits(), kFft, kNoise, focus_at(600), seen);
}

TEST(TrackFocus, TellsWhereAMovingPeakIsNow) {
  double squares = 0, count = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const double speed = -6 + 0.6 * seed;
    MovingScene scene(600 - 24 * speed, speed, seed);
    const Focus focus = tracked(scene);
    if (focus.result() != FocusResult::focused) continue;
    const double error = focus.position() - scene.peak();
    squares += std::pow(error / focus.peak.sigma, 2);
    ++count;
    EXPECT_LT(std::abs(error), std::max(4 * focus.peak.sigma, 1.0)) << speed;
    EXPECT_LT(focus.peak.sigma, 0.3 * kHalfWidth);
  }
  EXPECT_GE(count, 15);
  EXPECT_LT(std::sqrt(squares / count), 1.3);
}

TEST(TrackFocus, IsLessSureOfSaturatedPictures) {
  MovingScene clear(600, 2, 3), bright(600, 2, 3);
  bright.saturated = 0.25;
  const Focus sure = tracked(clear), unsure = tracked(bright);
  ASSERT_EQ(sure.result(), FocusResult::focused);
  EXPECT_EQ(unsure.position(), sure.position());
  EXPECT_NEAR(unsure.verdict.confidence, 0.75 * sure.verdict.confidence, 1e-9);
  EXPECT_NEAR(std::pow(unsure.peak.sigma, 2) - std::pow(sure.peak.sigma, 2),
              std::pow(saturation_sigma(0.25, sure.peak.half_width), 2), 1e-9);
}

TEST(TrackFocus, KnowsATargetThatStandsByFewLooks) {
  MovingScene scene(600, 0, 1);
  const Focus focus = tracked(scene);
  ASSERT_EQ(focus.result(), FocusResult::focused);
  EXPECT_NEAR(focus.position(), 600, 3 * focus.peak.sigma);
  EXPECT_LT(focus.peak.sigma, 1);
  EXPECT_LE(focus.evaluations.size(), 5u);
}

TEST(TrackFocus, DoesNotBelieveATargetThatIsGone) {
  MovingScene scene(600, 3, 1);
  const TimedObjective timed = scene.timed();
  for (const double beside : {-15, 15, 0}) timed.objective.score(600 + beside);
  const std::vector<Sighting> seen = scene.seen;
  scene.is_there = false;
  const Focus focus = track_focus(timed, limits(), kFft, kNoise, focus_at(600), seen);
  EXPECT_NE(focus.result(), FocusResult::focused);
}

TEST(TrackFocus, LooksEverywhereForATargetThatWasNotThere) {
  MovingScene scene(800, 1, 2);
  const TimedObjective timed = scene.timed();
  timed.objective.score(300);
  const std::vector<Sighting> seen = scene.seen;
  const Focus focus = track_focus(timed, limits(), kFft, kNoise, focus_at(300), seen);
  ASSERT_EQ(focus.result(), FocusResult::focused);
  EXPECT_NEAR(focus.position(), scene.peak(), 4 * focus.peak.sigma);
  EXPECT_EQ(focus.evaluations.size() + 1, scene.seen.size()) << "all that was done is told";
}

TEST(TrackFocus, DoesNotTakeTheSlopeAtTheEndForAPeak) {
  MovingScene scene(1300, 0, 3);
  const TimedObjective timed = scene.timed();
  for (const double at : {1150, 1170, 1190}) timed.objective.score(at);
  const std::vector<Sighting> seen = scene.seen;
  const Focus focus = track_focus(timed, limits(), kFft, kNoise, focus_at(1180), seen);
  EXPECT_NE(focus.result(), FocusResult::focused);
}

PeakTemplate known_peak() {
  return {.floor = kFloor,
          .height = kHeight,
          .height_part = 0.2,
          .half_width = kHalfWidth,
          .width_part = 0.2,
          .noise = kNoise * kFloor};
}

TEST(Locate, FindsPositionAndSpeed) {
  std::vector<Sighting> sightings;
  for (int i = 0; i < 8; ++i) {
    const double time = 0.7 * i, peak = 500 + 6 * time, position = peak + (i % 2 ? 15 : -16);
    const double z = (position - peak) / kHalfWidth;
    sightings.push_back({position, kFloor + kHeight / (1 + z * z), time});
  }
  const MovingPeak found = locate(sightings, known_peak(), 400, 700);
  EXPECT_NEAR(found.position, 500 + 6 * 4.9, 3 * found.sigma);
  EXPECT_NEAR(found.speed, 6, 3 * found.speed_sigma);
  EXPECT_LT(found.sigma, 3);
  EXPECT_LT(found.misfit, 2);
}

TEST(Locate, OfOneSlopeAloneDoesNotKnowWhichSide) {
  const double z = 15 / kHalfWidth, score = kFloor + kHeight / (1 + z * z);
  const std::vector<Sighting> sightings = {{500, score, 0}};
  EXPECT_GT(locate(sightings, known_peak(), 400, 600).sigma, 10);
}

}  // namespace
}  // namespace fathom
