// SPDX-License-Identifier: Apache-2.0
// What is left for the eye: one picture of a rig, plots, the spectrum with axes; and the runs that pile up.
#include "pictures/picture.hpp"
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using Seen = Program;

bool is_png(const std::string& bytes) { return bytes.starts_with("\x89PNG"); }

bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST_F(Seen, SnapMarksTheWindowAndLeavesItAsItIs) {
  const Outcome text = fathom("snap --rig sim:target=seedling --window 96,88,64 --at 800 -o a.png");
  ASSERT_EQ(text.status, 0) << text.err;
  for (const char* words : {"256 x 240 px, 8 bit, lens at 800 steps", "window 96,88,64",
                            "histogram", "exposure: ", "picture written to a.png"})
    EXPECT_TRUE(has(text.out, words)) << text.out;
  PictureFile file(path("a.png"));
  EXPECT_TRUE(file.is_colour());
  const Frame red = PictureFile(path("a.png"), {.colour = Colour::red}).read(0);
  const Frame blue = PictureFile(path("a.png"), {.colour = Colour::blue}).read(0);
  EXPECT_EQ(red.at(95, 100), 255u);  // orange, one pixel outside
  EXPECT_EQ(blue.at(95, 100), 0u);
  for (int x = 96; x < 160; ++x) EXPECT_EQ(red.at(x, 88), blue.at(x, 88));
}

TEST_F(Seen, SnapAdvisesOnTheExposure) {
  const auto advice = [&](const std::string& rig) {
    const auto lines = fathom("snap --rig " + rig + " --json").lines();
    return lines.at(0).at("exposure").get<std::string>();
  };
  EXPECT_TRUE(advice("sim:target=usaf,exposure_ms=1").starts_with("too dark"));
  EXPECT_TRUE(advice("sim:target=usaf,exposure_ms=200").starts_with("too bright"));
  EXPECT_TRUE(advice("sim:target=usaf").starts_with("good"));
}

TEST_F(Seen, SnapJsonHasTheHistogramOfAllPixels) {
  const auto line = fathom("snap --rig sim --json").lines().at(0);
  std::size_t pixels = 0;
  for (const auto& bin : line.at("histogram")) pixels += bin.get<std::size_t>();
  EXPECT_EQ(pixels, 256u * 240u);
  EXPECT_GT(line.at("score"), 0);
}

TEST_F(Seen, PlotsShowTheAnswerAndNoneWhereThereIsNone) {
  const std::string focus = "focus --rig sim:distance=1500 --search coarse --plot ";
  ASSERT_EQ(fathom(focus + "curve.svg").status, 0);
  const std::string sharp = contents(path("curve.svg"));
  for (const char* words : {"focused at 9", "+-", "fitted ", "evaluated"})
    EXPECT_TRUE(has(sharp, words)) << words;
  ASSERT_EQ(fathom("focus --rig sim:target=blank --plot blank.svg").status, 3);
  const std::string blank = contents(path("blank.svg"));
  EXPECT_TRUE(has(blank, "no-focus"));
  for (const char* words : {"focused at", "best"}) EXPECT_FALSE(has(blank, words)) << words;
  ASSERT_EQ(fathom(focus + "curve.png").status, 0);
  EXPECT_TRUE(is_png(contents(path("curve.png"))));
}

TEST_F(Seen, TheTerminalMarksWhatWasEvaluated) {
  const std::string drawn = fathom("focus --rig sim:distance=1500 --search coarse --plot -").out;
  EXPECT_GE(
      std::count(drawn.begin(), drawn.begin() + static_cast<std::ptrdiff_t>(drawn.find("└")), 'o'),
      8)
      << drawn;
  expect_refusal("focus --rig sim --plot curve.jpg", 2, {".svg", ".png"});
}

TEST_F(Seen, SpectraHaveAxesAndTheWindowBesideThem) {
  ASSERT_EQ(fathom("snap --rig sim:target=usaf --at 781 -o a.png").status, 0);
  const Outcome drawn = fathom("spectrum a.png --plot s.svg");
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  const std::string figure = contents(path("s.svg"));
  for (const char* words : {"horizontal, cycles per pixel", "dB below the peak", "Window 96,88,64"})
    EXPECT_TRUE(has(figure, words)) << words;
  ASSERT_EQ(fathom("spectrum a.png --metric walsh-paley --plot s.png").status, 0);
  EXPECT_TRUE(is_png(contents(path("s.png"))));
  expect_refusal("spectrum a.png", 2, {"-o", "--plot"});
}

TEST_F(Seen, RunsAreListedShownAndPruned) {
  for (int i = 0; i < 3; ++i)
    ASSERT_EQ(fathom("sweep --rig sim --from 700 --to 800 --step 50").status, 0);
  ASSERT_EQ(fathom("focus --rig sim:distance=1500").status, 0);
  write("state/fathom/runs/mine.json", "not a run of its own naming");
  const Outcome list = fathom("runs list");
  EXPECT_TRUE(has(list.out, "4 of 4 runs")) << list.out;
  EXPECT_TRUE(has(list.out, "3 positions")) << list.out;
  EXPECT_TRUE(has(fathom("runs show last").out, "focused at"));
  EXPECT_EQ(fathom("runs list --most 2 --json").lines().size(), 2u);
  EXPECT_TRUE(has(fathom("runs prune --keep 1 --dry-run").out, "3 runs of 4 would be deleted"));
  EXPECT_TRUE(has(fathom("runs list").out, "4 of 4 runs"));
  EXPECT_TRUE(has(fathom("runs prune --keep 1").out, "3 runs of 4 deleted"));
  EXPECT_TRUE(has(fathom("runs list").out, "1 of 1 runs"));
  EXPECT_EQ(contents(path("state/fathom/runs/mine.json")), "not a run of its own naming");
  expect_refusal("runs show nothing", 1, {"nothing"});
  expect_refusal("runs prune", 2, {"--keep"});
}

}  // namespace
}  // namespace fathom::test
