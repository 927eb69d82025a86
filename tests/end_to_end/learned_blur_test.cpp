// SPDX-License-Identifier: Apache-2.0
// A lens that says nothing of itself: what the first measurement learns of its blur makes the
// second one quicker.
#include "tests/end_to_end/program.hpp"

namespace fathom::test {
namespace {

using LearnedBlur = Program;

constexpr const char* kUntold = "--rig sim:optics=untold,start=500,target=";

double travel_of(const Outcome& outcome) { return outcome.lines().back().at("travel"); }

bool says(const Outcome& outcome, const std::string& words) {
  return outcome.err.find(words) != std::string::npos;
}

TEST_F(LearnedBlur, MakesTheSecondSearchQuicker) {
  const std::string first = std::string("focus --json ") + kUntold + "usaf -o run.json";
  const std::string second = std::string("focus --json ") + kUntold + "seedling -o again.json";
  const Outcome unknown = fathom(first);
  ASSERT_EQ(unknown.status, 0) << unknown.err;
  EXPECT_TRUE(says(unknown, "blur of the lens learned: 0.08")) << unknown.err;
  const Outcome known = fathom(second);
  ASSERT_EQ(known.status, 0) << known.err;
  EXPECT_TRUE(says(known, "px a step, learned 20")) << known.err;
  EXPECT_TRUE(says(known, "--blur overrides")) << known.err;
  EXPECT_LT(travel_of(known), 0.2 * travel_of(unknown));
  EXPECT_NEAR(known.lines().back().at("position"), 782, 4);
  EXPECT_EQ(fathom("rerun again.json --json").status, 0);
}

TEST_F(LearnedBlur, IsLearnedFromASweep) {
  const Outcome swept =
      fathom(std::string("sweep --json --from 660 --to 900 --step 10 ") + kUntold + "usaf");
  EXPECT_TRUE(says(swept, "blur of the lens learned: 0.08")) << swept.err;
  const Outcome known = fathom(std::string("focus --json ") + kUntold + "usaf");
  EXPECT_TRUE(says(known, "learned 20")) << known.err;
}

TEST_F(LearnedBlur, GivesWayToWhatIsToldAndIsReplacedWhereItIsWrong) {
  ASSERT_EQ(fathom(std::string("focus --json ") + kUntold + "usaf").status, 0);
  const Outcome told = fathom(std::string("focus --json --blur 0.25 ") + kUntold + "usaf");
  EXPECT_EQ(told.status, 0);
  EXPECT_FALSE(says(told, "learned 20")) << told.err;
  EXPECT_TRUE(says(told, "do not defocus by 0.25 px a step")) << told.err;
  // As if the lens had been changed since.
  for (const auto& file : std::filesystem::directory_iterator(path("state/fathom/blur"))) {
    auto json = nlohmann::json::parse(contents(file.path()));
    json["blur"]["px_per_unit"] = 0.25;
    write("state/fathom/blur/" + file.path().filename().string(), json.dump());
  }
  const Outcome changed = fathom(std::string("focus --json ") + kUntold + "usaf");
  EXPECT_TRUE(says(changed, "do not defocus by 0.25 px a step")) << changed.err;
  EXPECT_TRUE(says(changed, "blur of the lens learned: 0.0")) << changed.err;
  EXPECT_NEAR(changed.lines().back().at("position"), 781, 2);
  for (const auto& file : std::filesystem::directory_iterator(path("state/fathom/blur"))) {
    const auto json = nlohmann::json::parse(contents(file.path()));
    EXPECT_NEAR(json["blur"]["px_per_unit"], 0.08, 0.005);
  }
  EXPECT_TRUE(says(fathom(std::string("focus --json ") + kUntold + "usaf"), "lens: 0.0"));
}

TEST_F(LearnedBlur, IsPassedOverWhereItsFileIsDamaged) {
  ASSERT_EQ(fathom(std::string("focus --json ") + kUntold + "usaf").status, 0);
  for (const auto& file : std::filesystem::directory_iterator(path("state/fathom/blur")))
    write("state/fathom/blur/" + file.path().filename().string(), "{\"format\":");
  const Outcome outcome = fathom(std::string("focus --json ") + kUntold + "usaf");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(says(outcome, "is damaged")) << outcome.err;
  EXPECT_TRUE(says(outcome, "blur of the lens learned")) << outcome.err;
}

TEST_F(LearnedBlur, StandsInTheCalibration) {
  ASSERT_EQ(
      fathom(std::string("calibrate --distances 1500,1800,2200 -o cal.json ") + kUntold + "usaf")
          .status,
      0);
  const auto json = nlohmann::json::parse(contents(path("cal.json")));
  EXPECT_NEAR(json.at("conditions").at("blur").at("px_per_unit"), 0.0824, 0.006);
  std::filesystem::remove_all(path("state"));
  const Outcome ranged =
      fathom(std::string("range --json --calibration cal.json ") + kUntold + "usaf,distance=2000");
  EXPECT_EQ(ranged.status, 0) << ranged.err;
  EXPECT_TRUE(says(ranged, "from the calibration")) << ranged.err;
  EXPECT_NEAR(ranged.lines().back().at("distance_mm"), 2000, 10);
}

TEST_F(LearnedBlur, IsFittedWithTheFocusOfARecording) {
  ASSERT_EQ(fathom("capture --rig sim:optics=untold --from 640 --to 904 --step 44 -o stack").status,
            0);
  const Outcome outcome = fathom("focus --rig replay:stack --search spectral --json -o run.json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NEAR(outcome.lines().back().at("position"), 781, 4);
  EXPECT_NE(contents(path("run.json")).find("\"spectral_end\": \"found\""), std::string::npos);
  EXPECT_EQ(fathom("rerun run.json --json").status, 0);
}

}  // namespace
}  // namespace fathom::test
