// SPDX-License-Identifier: Apache-2.0
// fathom optics, as a user types it.
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using OpticsVerb = Program;

const char* const kThesisLens = "optics --focal 135 --fnumber 4 --distance 1500";

TEST_F(OpticsVerb, SaysWhatTheThesisLensCanTellApart) {
  const Outcome outcome = fathom(kThesisLens);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* words :
       {"135 mm lens at f/4, focused on 1500 mm", "image distance       148.352 mm",
        "Airy radius          2.68 um", "near limit           1480.5 mm",
        "depth of field       39.51 mm", "depth, exact         35.96 mm",
        "working f-number     4.396", "hyperfocal distance  113906 mm"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words << " in\n" << outcome.out;
  }
}

TEST_F(OpticsVerb, JsonHasUnitsInItsNames) {
  const auto lines =
      fathom("optics --focal 135 --fnumber 2.8 --distance 2500 --coc 0.04 --wavelength 500 --json")
          .lines();
  ASSERT_EQ(lines.size(), 1u);
  const auto& line = lines[0];
  EXPECT_EQ(line.size(), 21u);
  EXPECT_EQ(line.at("focal_mm"), 135);
  EXPECT_EQ(line.at("f_number"), 2.8);
  EXPECT_EQ(line.at("distance_mm"), 2500);
  EXPECT_EQ(line.at("circle_mm"), 0.04);
  EXPECT_EQ(line.at("wavelength_nm"), 500);
  EXPECT_NEAR(line.at("image_mm"), 142.706, 1e-3);
  EXPECT_NEAR(line.at("extension_mm"), 7.706, 1e-3);
  EXPECT_NEAR(line.at("magnification"), 135.0 / 2365, 1e-12);
  EXPECT_NEAR(line.at("airy_radius_um"), 1.22 * 0.5 * 2.8, 1e-12);
  EXPECT_GT(line.at("airy_radius_here_um"), line.at("airy_radius_um"));
  EXPECT_NEAR(line.at("disc_mm_per_mm_defocus"), 1 / (2.8 * 2500 / 2365), 1e-12);
  EXPECT_NEAR(line.at("depth_of_field_mm"), 76.8, 0.05);
  EXPECT_NEAR(line.at("far_mm").get<double>() - line.at("near_mm").get<double>(), 76.8, 0.05);
  EXPECT_NEAR(line.at("half_depth_percent"), 76.8 / 2 / 25, 1e-2);
  EXPECT_NEAR(line.at("hyperfocal_mm"), 162723.2, 0.1);
  EXPECT_NEAR(line.at("depth_of_focus_mm"), 2 * 0.04 * 2.8 * 2500 / 2365, 1e-12);
}

TEST_F(OpticsVerb, BeyondTheHyperfocalDistanceItIsSharpToInfinity) {
  for (const char* distance : {"200000", "inf"}) {
    const std::string command =
        std::string("optics --focal 135 --fnumber 4 --distance ") + distance;
    const Outcome text = fathom(command);
    EXPECT_EQ(text.status, 0) << text.err;
    EXPECT_NE(text.out.find("far limit            infinite"), std::string::npos) << text.out;
    EXPECT_EQ(text.out.find("nan"), std::string::npos) << text.out;
    const auto line = fathom(command + " --json").lines().at(0);
    EXPECT_TRUE(line.at("far_mm").is_null());
    EXPECT_TRUE(line.at("depth_of_field_mm").is_null());
    EXPECT_GT(line.at("near_mm"), 70000);
  }
}

void expect_figure(const std::string& svg, const std::vector<std::string>& words) {
  EXPECT_NE(svg.find("<svg"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  for (const std::string& word : words) EXPECT_NE(svg.find(word), std::string::npos) << word;
}

TEST_F(OpticsVerb, DrawsTheThesisFigures) {
  const Outcome outcome = fathom(std::string(kThesisLens) + " --plot a/figures");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("a/figures"), std::string::npos);
  expect_figure(contents(path("a/figures/figure-3-depth-of-field.svg")),
                {"object distance (mm)", "depth of field (mm)", "135 mm", "f/2.8", "f/4", "f/5.6",
                 "f/8", "39.5 mm at 1500 mm"});
  expect_figure(contents(path("a/figures/figure-4-mtf.svg")),
                {"modulation", "cycles/mm", "550 nm", "n = 0", "n = 8", "rays"});
  expect_figure(contents(path("a/figures/figure-14-object-distance.svg")),
                {"image distance", "object distance (mm)", "148.352 mm"});
}

TEST_F(OpticsVerb, DrawsAnyLens) {
  for (const char* lens :
       {"--focal 135 --fnumber 4 --distance inf", "--focal 135 --fnumber 4 --distance 136",
        "--focal 4 --fnumber 1.8 --distance 1e6 --coc 0.002",
        "--focal 50 --fnumber 90 --distance 60", "--focal 5 --fnumber 32 --distance 9 --coc 0.1"}) {
    const Outcome outcome = fathom(std::string("optics --json --plot f ") + lens);
    EXPECT_EQ(outcome.status, 0) << lens << ": " << outcome.err;
    EXPECT_EQ(outcome.lines().size(), 1u) << lens;
    EXPECT_EQ(outcome.err, "") << lens;
  }
}

TEST_F(OpticsVerb, RefusesWhatNoLensHas) {
  const auto refuse = [&](const std::string& rest, const std::vector<std::string>& words) {
    expect_refusal("optics " + rest, 2, words);
  };
  refuse("--focal 0 --fnumber 4 --distance 1500", {"focal length", "0 mm", "above 0"});
  refuse("--focal -1 --fnumber 4 --distance 1500", {"focal length", "-1 mm"});
  refuse("--focal nan --fnumber 4 --distance 1500", {"focal length"});
  refuse("--focal 135 --fnumber 0 --distance 1500", {"f-number", "above 0"});
  refuse("--focal 135 --fnumber 4 --distance 135", {"135 mm lens", "above the focal length"});
  refuse("--focal 135 --fnumber 4 --distance nan", {"nan"});
  refuse("--focal 135 --fnumber 4 --distance 1500 --coc 0", {"circle of confusion"});
  refuse("--focal 135 --fnumber 4 --distance 1500 --wavelength -5", {"wavelength"});
  refuse("--focal 135 --fnumber 4 --distance far", {"--distance far", "write a number"});
  refuse("--focal 135 --fnumber 4", {"--distance"});
  refuse("--focal 135 --fnumber 4 --distance 1500 --plot -", {"--plot", "folder"});
  refuse("--focal 135 --fnumber 4 --distance 1500 --plot lens.svg", {"lens.svg", "folder"});
  refuse("--focal 5 --fnumber 32 --distance 9 --coc 1 --plot f", {"5 mm lens", "circle"});
}

TEST_F(OpticsVerb, AFolderThatCannotBeMadeIsAnError) {
  write("taken", "a file");
  const Outcome outcome = fathom(std::string(kThesisLens) + " --plot taken");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("taken"), std::string::npos);
  EXPECT_EQ(contents(path("taken")), "a file");
}

}  // namespace
}  // namespace fathom::test
