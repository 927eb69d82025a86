// SPDX-License-Identifier: Apache-2.0
// A lens that the camera moves as one of its features.
#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

Hardware open_lens(const std::string& keys) {
  return open_hardware(gige(",settle_ms=1" + keys), {.camera = false, .lens = true});
}

TEST(AravisLens, HasTheTravelAndTheUnitOfItsFeature) {
  FakeGige fake;
  const Hardware rig = open_lens(",lens=FocusPos");
  const LensInfo info = rig.lens->info();
  EXPECT_EQ(info.unit, "steps");
  EXPECT_EQ(info.lowest, 0);
  EXPECT_EQ(info.highest, FakeGige::kLensTravel);
  EXPECT_EQ(info.resolution, 1);
  EXPECT_EQ(rig.lens->move_to(321.4).position, 321);
  EXPECT_EQ(fake.lens_position(), 321);
  EXPECT_EQ(rig.lens->position(), 321);
  EXPECT_FALSE(rig.lens->can_be_watched());
  expect_error(ErrorCode::out_of_bounds, [&] { rig.lens->move_to(1201); });
  EXPECT_EQ(fake.lens_position(), 321);
}

TEST(AravisLens, MayBeALiquidLensThatCountsInDioptres) {
  const FakeGige fake;
  const Hardware rig = open_lens(",lens=FocalPower,step=0.01,lowest=-1,highest=2");
  EXPECT_EQ(rig.lens->info().unit, "dpt");
  EXPECT_EQ(rig.lens->info().lowest, -1);
  EXPECT_EQ(rig.lens->info().highest, 2);
  EXPECT_NEAR(rig.lens->move_to(1.234).position, 1.23, 1e-9);
  EXPECT_NEAR(rig.lens->position(), 1.23, 1e-6);
}

TEST(AravisLens, IsRefusedWhereThereIsNoneOfThatName) {
  const FakeGige fake;
  const auto refused = [](const std::string& keys, std::initializer_list<const char*> words) {
    expect_error(
        ErrorCode::unsupported, [&] { open_lens(keys); }, words);
  };
  refused(",lens=Focus", {"\"Focus\"", "lens=FocalPower, FocusPos"});
  refused(",lens=GainAuto", {"GainAuto", "no number"});
  refused(",lens=FocusPos,lowest=5,highest=2000", {"0 to 1200"});
  expect_error(ErrorCode::unavailable, [] { open_lens(""); }, {"no lens"});
}

}  // namespace
}  // namespace fathom::test
