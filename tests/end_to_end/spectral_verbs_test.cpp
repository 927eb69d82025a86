// SPDX-License-Identifier: Apache-2.0
// What spectra tell of a focus, as a user types it.
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using Spectral = Program;

constexpr double kFocus1700 = 831.2;  // 1200 * 1084 / (1700 - 135)

TEST_F(Spectral, TakesNoMoreFramesThanItMay) {
  for (const int start : {700, 760, 900, 1000}) {
    const std::string rig = "--rig sim:distance=1700,start=" + std::to_string(start);
    const Outcome outcome = fathom("focus " + rig + " --frames 3 --json -o run.json");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto result = outcome.lines().back();
    EXPECT_LE(result.at("frames"), 3);
    EXPECT_LE(result.at("evaluations"), 3);
    EXPECT_TRUE(result.at("second_looks").empty());
    EXPECT_NEAR(result.at("position"), kFocus1700, 4 * result.at("sigma").get<double>() + 0.5);
    EXPECT_EQ(fathom("rerun run.json --json").status, 0);
  }
}

TEST_F(Spectral, SaysWhatTheLensDid) {
  const std::string rig = "--rig sim:distance=1700,start=300 --json";
  const auto spectral = fathom("focus " + rig).lines().back();
  const auto coarse = fathom("focus " + rig + " --search coarse").lines().back();
  const double direct = kFocus1700 - 300;
  EXPECT_GE(spectral.at("travel"), direct);
  EXPECT_LT(spectral.at("travel"), 1.5 * direct);
  EXPECT_LT(spectral.at("rig_seconds"), 1.5 * direct / 25 + 3);
  EXPECT_GE(spectral.at("frames"), spectral.at("evaluations"));
  EXPECT_GT(coarse.at("travel"), 2 * direct);
  EXPECT_GT(coarse.at("rig_seconds"), spectral.at("rig_seconds"));
  EXPECT_NEAR(spectral.at("position"), coarse.at("position"), 1);
}

TEST_F(Spectral, GoesWithoutAHaltAndSaysSo) {
  const std::string rig = "--rig sim:distance=1700,start=300 --json ";
  const auto moving = fathom("focus " + rig + "--moving -o run.json").lines().back();
  const auto halting = fathom("focus " + rig + "--halting").lines().back();
  EXPECT_EQ(moving.at("moving"), true);
  EXPECT_EQ(halting.at("moving"), false);
  EXPECT_LT(moving.at("rig_seconds"), halting.at("rig_seconds"));
  EXPECT_GT(moving.at("frames"), halting.at("frames"));
  EXPECT_NEAR(moving.at("position"), kFocus1700, 1);
  EXPECT_EQ(fathom("rerun run.json --json").status, 0);
}

TEST_F(Spectral, RefusesWhatItCannotDo) {
  const auto refused = [this](const std::string& line, const std::string& word) {
    const Outcome outcome = fathom("focus --rig sim " + line);
    EXPECT_EQ(outcome.status, 2) << line;
    EXPECT_NE(outcome.err.find(word), std::string::npos) << line << ": " << outcome.err;
  };
  refused("--frames 1", "3 frames are the least");
  refused("--frames 2", "3 frames are the least");
  refused("--frames -3", "3 frames are the least");
  refused("--frames 3 --search golden", "golden");
  refused("--blur 0", "0 px per unit");
  refused("--blur nan", "blur");
  refused("--blur 0.08 --na 0.5 --pixel 0.3", "leave one of them out");
  refused("--na 0.5", "--pixel");
  refused("--na 2 --pixel 0.3", "aperture");
  refused("--moving --halting", "contradict");
  refused("--moving --search coarse", "by coarse needs a halt");
  refused("--moving --frames 3", "halts for each");
}

TEST_F(Spectral, ARecordingIsSearchedWithTheBlurThatSomebodyTellsOrItsPicturesDo) {
  ASSERT_EQ(
      fathom("capture --rig sim:distance=1500 --from 780 --to 1100 --step 20 -o stack").status, 0);
  // Three frames do not tell a blur as well.
  const Outcome unknown = fathom("focus --rig replay:stack --frames 3");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("how the lens blurs"), std::string::npos) << unknown.err;
  for (const char* told : {"--blur 0.08", ""}) {
    const Outcome found =
        fathom(std::string("focus --rig replay:stack --search spectral --json ") + told);
    ASSERT_EQ(found.status, 0) << found.err;
    EXPECT_NEAR(found.lines().back().at("position"), 953, 3);  // 1200 * 1084 / (1500 - 135)
  }
}

}  // namespace
}  // namespace fathom::test
