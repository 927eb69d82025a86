// SPDX-License-Identifier: Apache-2.0
// Searches on a blank card whose noise, which is not white, swells and falls.
#include "session/beside.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "session/run_file.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"
#include "tests/support/grain.hpp"

namespace fathom::test {
namespace {

/// What stands before the camera, and how it is taken.
struct Card {
  bool is_live = false;
  bool has_texture = false;  ///< Sharpest where the noise is most.
  unsigned seed = 0;         ///< Of the noise.
  double position = 0;
  std::int64_t clock_ns = 0;
  unsigned frames = 0;
};

class CardLens final : public Lens {
 public:
  explicit CardLens(std::shared_ptr<Card> card) : card_(std::move(card)) {}
  LensInfo info() const override {
    LensInfo info{"lens", "steps", 0, 20, 1, 1, {}};
    if (card_->is_live) return info;
    for (int i = 0; i <= 20; ++i) info.stops.push_back(i);
    return info;
  }
  double position() const override { return card_->position; }
  Arrival move_to(double wanted) override {
    card_->position = nearest(wanted);
    const std::int64_t now = ++card_->clock_ns;
    return {.position = card_->position, .started_ns = now, .stopped_ns = now, .settled_ns = now};
  }
  Arrival home() override { return move_to(0); }

 private:
  std::shared_ptr<Card> card_;
};

class CardCamera final : public Camera {
 public:
  explicit CardCamera(std::shared_ptr<Card> card) : card_(std::move(card)) {}
  std::string description() const override { return "camera"; }
  CameraSettings settings() const override { return {kSide, kSide, Depth::bits8, 10}; }
  Validity validate(CameraSettings&) const override { return Validity::valid; }
  void apply(const CameraSettings&) override {}
  bool is_live() const override { return card_->is_live; }
  std::optional<Frame> grab(std::chrono::milliseconds) override {
    ++card_->frames;
    const double bell = std::exp(-std::pow((card_->position - 9) / 3, 2));
    const auto noise = noise_now().smooth(kSide, 2);
    const auto texture = Grains(77).smooth(kSide, 2);
    std::vector<std::uint8_t> pixels;
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const double grey =
          card_->has_texture ? noise[i] + 6 * bell * texture[i] : (1 + 3 * bell) * noise[i];
      pixels.push_back(static_cast<std::uint8_t>(std::lround(128 + grey)));
    }
    Frame frame(kSide, kSide, std::move(pixels));
    frame.exposure = {card_->clock_ns + 1, card_->clock_ns + 2};
    card_->clock_ns += 2;
    return frame;
  }

 private:
  static constexpr int kSide = 64;

  /// A recording shows a place always alike.
  Grains noise_now() const {
    return Grains(1 + card_->seed +
                  (card_->is_live ? card_->frames : static_cast<unsigned>(card_->position)));
  }

  std::shared_ptr<Card> card_;
};

RunFile searched(const Card& card) {
  const auto shared = std::make_shared<Card>(card);
  RigOptions options;
  options.rig = "test";
  options.metric = "walsh-sequency";
  options.backend = "cpu";
  Rig rig(options,
          {std::make_unique<CardCamera>(shared), std::make_unique<CardLens>(shared), nullptr});
  RunKeeper keeper(setup_of(rig));
  const Run run = Session(rig).focus({}, keeper);
  EXPECT_EQ(rig.lens().position(),
            (run.focus->second_looks.empty() ? run.focus->evaluations : run.focus->second_looks)
                .back()
                .position)
      << "the lens stays where the search left it";
  return std::move(keeper.file);
}

class Beside : public ::testing::TestWithParam<bool> {};

TEST_P(Beside, NoiseThatSwellsIsNoFocus) {
  int unshared = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Focus focus = *searched({.is_live = GetParam(), .seed = 1000 * seed}).runs[0].focus;
    EXPECT_EQ(focus.result(), FocusResult::no_focus) << seed;
    unshared += focus.verdict.reason.why == Why::unshared ? 1 : 0;
  }
  // A second look may have told, too, that what it saw had changed.
  EXPECT_GE(unshared, GetParam() ? 1 : 6);
}

TEST_P(Beside, ATextureInTheSameNoiseIsAFocus) {
  const Focus focus = *searched({.is_live = GetParam(), .has_texture = true}).runs[0].focus;
  ASSERT_EQ(focus.result(), FocusResult::focused) << to_string(focus.verdict.reason.why);
  EXPECT_NEAR(focus.position(), 9, 0.5);
  EXPECT_GT(focus.verdict.confidence, 0.5);
  EXPECT_GE(focus.resemblance.value().evidence, kEvident);
}

TEST_P(Beside, IsKeptForAnotherComputation) {
  const RunFile file = searched({.is_live = GetParam()});
  const RunFile read = RunFile::parse(file.json(), "run");
  EXPECT_EQ(read.runs[0].resemblance, file.runs[0].resemblance);
  EXPECT_TRUE(same_answer(read, rerun(read, "run")));
}

INSTANTIATE_TEST_SUITE_P(LiveOrNot, Beside, ::testing::Bool());

}  // namespace
}  // namespace fathom::test
