// SPDX-License-Identifier: Apache-2.0
// What is learned of a lens's blur on the simulated rig, and how that is kept.
#include "session/blur_store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "engine/file.hpp"
#include "session/session.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace fathom {
namespace {

using test::expect_error;

/// The thesis rig's optics tell this, px a step at mid travel (hal/drivers/simulated/lens.cpp).
constexpr double kTold = 0.0824;

const LearnedBlur kBlur{.model = {.px_per_unit = 0.08, .rest_px = 0.5, .uncertainty = 0.04},
                        .pictures = 17,
                        .learned = "2026-01-02T03:04:05Z"};

Rig rig_of(const std::string& text) {
  RigOptions options;
  options.rig = text;
  options.backend = "cpu";
  return Rig(options);
}

/// Keeps the doubts about the blur.
class Doubts final : public Observer {
 public:
  void warned(const Warning& warning) override {
    if (const auto* doubted = std::get_if<BlurDoubted>(&warning)) all.push_back(*doubted);
  }
  std::vector<BlurDoubted> all;
};

std::optional<LearnedBlur> swept(const std::string& text, double middle) {
  Rig rig = rig_of(text);
  Observer nobody;
  return blur_of(
      Session(rig).sweep({.from = middle - 120, .to = middle + 120, .step = 10}, nobody));
}

TEST(BlurOfASweep, IsThatOfTheOptics) {
  for (const char* seed : {"1", "2", "3"}) {
    const std::string rig = std::string("sim:optics=untold,seed=") + seed;
    const auto usaf = swept(rig, 780);
    ASSERT_TRUE(usaf) << seed;
    EXPECT_NEAR(usaf->model.px_per_unit / kTold, 1, 0.05) << seed;
    const auto seedling = swept(rig + ",target=seedling", 780);
    ASSERT_TRUE(seedling) << seed;
    EXPECT_NEAR(seedling->model.px_per_unit / kTold, 1, 0.1) << seed;
  }
  const auto small = swept("sim:optics=untold,fnumber=8", 780);
  ASSERT_TRUE(small);
  EXPECT_NEAR(small->model.px_per_unit / (kTold / 2), 1, 0.1);
}

TEST(BlurOfASweep, IsNothingWithoutAFocus) {
  EXPECT_FALSE(swept("sim:optics=untold,target=blank", 780));
  EXPECT_FALSE(swept("sim:optics=untold", 400)) << "the focus lies beyond the sweep";
}

TEST(SearchWithTheBlurOfAnotherRig, FindsTheFocusAndDoubtsTheBlur) {
  for (const double factor : {3.0, 1 / 3.0}) {
    for (const char* target : {"usaf", "seedling"}) {
      Rig rig = rig_of(std::string("sim:start=300,target=") + target);
      FocusRequest request;
      request.blur = BlurModel{.px_per_unit = factor * kTold};
      Doubts doubts;
      const fathom::Run run = Session(rig).focus(request, doubts);
      EXPECT_EQ(run.focus->result(), FocusResult::focused);
      EXPECT_NEAR(run.focus->position(), 781, 5) << target << " x " << factor;
      ASSERT_EQ(doubts.all.size(), 1u) << target << " x " << factor;
      EXPECT_DOUBLE_EQ(doubts.all[0].used, factor * kTold);
      ASSERT_TRUE(doubts.all[0].seen);
      EXPECT_NEAR(*doubts.all[0].seen / kTold, 1, 0.1);
      const auto learned = blur_of(run);
      ASSERT_TRUE(learned);
      EXPECT_NEAR(learned->model.px_per_unit / kTold, 1, 0.1);
    }
  }
}

TEST(SearchWithTheBlurOfTheRig, DoubtsNothing) {
  for (const char* target : {"usaf", "seedling"}) {
    Rig rig = rig_of(std::string("sim:start=300,target=") + target);
    Doubts doubts;
    Session(rig).focus({}, doubts);
    EXPECT_TRUE(doubts.all.empty()) << target;
  }
}

TEST(BlurKey, IsOfTheLensAndNotOfTheScene) {
  Rig one = rig_of("sim:target=usaf,distance=1500,seed=4,fnumber=8");
  Rig same = rig_of("sim:fnumber=8,noise=3,start=20");
  Rig other = rig_of("sim:fnumber=4");
  EXPECT_EQ(blur_key(one), blur_key(same));
  EXPECT_NE(blur_key(one), blur_key(other));
}

TEST(BlurStore, KeepsOneForEachRig) {
  const test::TemporaryFolder folder;
  const BlurStore store(folder.path() / "blur");
  EXPECT_FALSE(store.find("a"));
  store.keep("a", kBlur);
  LearnedBlur other = kBlur;
  other.model.px_per_unit = 0.2;
  store.keep("b", other);
  EXPECT_EQ(store.find("a"), kBlur);
  EXPECT_EQ(store.find("b"), other);
  store.keep("a", other);
  EXPECT_EQ(store.find("a"), other);
}

TEST(BlurStore, RefusesWhatIsDamagedOrOfAnotherRig) {
  const test::TemporaryFolder folder;
  const BlurStore store(folder.path());
  store.keep("a", kBlur);
  const std::string good = read_file(store.path_of("a"));
  write_file(store.path_of("b"), good);
  expect_error(ErrorCode::bad_data, [&] { store.find("b"); }, {"another rig"});
  for (const std::string& bad : {std::string(), std::string("{}"), std::string("[1,2"),
                                 good.substr(0, good.size() / 2), std::string(100, '[')}) {
    write_file(store.path_of("a"), bad);
    EXPECT_THROW(store.find("a"), Error) << bad;
  }
  std::string negative = good;
  const auto at = negative.find("0.08");
  negative.replace(at, 4, "-1.0");
  write_file(store.path_of("a"), negative);
  EXPECT_THROW(store.find("a"), Error);
}

}  // namespace
}  // namespace fathom
