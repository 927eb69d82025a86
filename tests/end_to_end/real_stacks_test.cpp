// SPDX-License-Identifier: Apache-2.0
// Real focal stacks, where they are at hand: $FATHOM_DATA, else ../shared/data beside the project.
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

std::string data_folder() {
  const char* const folder = std::getenv("FATHOM_DATA");
  return folder != nullptr ? folder : FATHOM_SOURCE "/../shared/data";
}

class RealStacks : public Program {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(data_folder())) {
      GTEST_SKIP() << "no real stacks at " << data_folder() << "; set FATHOM_DATA to run this";
    }
  }
};

// A circuit board photographed at an angle: the top of the push button is sharpest in frame 6.
TEST_F(RealStacks, ThePushButtonIsSharpInFrameSix) {
  for (const char* metric : {"walsh-sequency", "walsh-paley", "fft", "fft:128:hann:power"}) {
    const Outcome outcome = fathom("focus --rig replay:" + data_folder() +
                                   "/pcb-depthmap --window 1000,700,128 --json --metric " + metric);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.lines().back().at("nearest"), 6) << metric;
    EXPECT_EQ(outcome.lines().back().at("result"), "focused") << metric;
  }
}

// A microscope stack with two sharp planes. The plain FFT score of its smallest windows is noise
// from end to end: that must be said, not ranged. Walsh sees both planes, and neither is the
// answer.
TEST_F(RealStacks, TheBacteriumHasTwoLobes) {
  const std::string focus =
      "focus --rig replay:" + data_folder() + "/brightfield/BF.tif --json --metric ";
  EXPECT_EQ(fathom(focus + "fft:32").lines().back().at("result"), "no-focus");
  for (const char* where : {"", " --window 0,26,32", " --window 20,60,32", " --window 23,84,32"}) {
    const Outcome outcome = fathom(focus + "walsh-sequency:32" + where);
    EXPECT_EQ(outcome.status, 3) << where;
    const auto answer = outcome.lines().back();
    EXPECT_EQ(answer.at("result"), "ambiguous") << where;
    auto lobes = answer.at("lobes").get<std::vector<double>>();
    ASSERT_GE(lobes.size(), 2u) << where;
    std::sort(lobes.begin(), lobes.begin() + 2);
    constexpr double kSpacing_um = 0.3;
    EXPECT_NEAR(lobes[0] / kSpacing_um, 11, 2) << where;
    EXPECT_NEAR(lobes[1] / kSpacing_um, 19, 2) << where;
  }
}

}  // namespace
}  // namespace fathom::test
