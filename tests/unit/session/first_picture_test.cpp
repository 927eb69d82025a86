// SPDX-License-Identifier: Apache-2.0
// What a picture from before a search tells of it, on a motor that loses steps and one that is driven
// too fast.
#include "session/first_picture.hpp"

#include <gtest/gtest.h>

#include <string>

#include "session/run_file.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"

namespace fathom::test {
namespace {

/// A search that leaves the lens at the focus, as `fathom focus` does.
RunFile search(const std::string& rig_text, SearchMethod method) {
  RigOptions options;
  options.rig = rig_text;
  Rig rig(options);
  RunKeeper keeper(setup_of(rig));
  FocusRequest request;
  request.search = method;
  Session(rig).focus(request, keeper);
  return keeper.file;
}

Verdict verdict_of(const RunFile& file) { return file.runs.back().focus->verdict; }

class FirstPicture : public testing::TestWithParam<SearchMethod> {};

TEST_P(FirstPicture, AgreesWhereTheLensStandsWhereItSays) {
  for (const char* target : {"usaf", "seedling", "orange"}) {
    for (const int start : {120, 480, 980}) {
      const std::string rig = "sim:distance=1900,seed=7,target=" + std::string(target) +
                              ",start=" + std::to_string(start);
      const RunFile file = search(rig, GetParam());
      EXPECT_EQ(verdict_of(file).result, FocusResult::focused) << rig;
      EXPECT_TRUE(file.runs.back().first_look) << rig;
    }
  }
}

TEST_P(FirstPicture, ShowsThatTheMotorWasTooFast) {
  for (const char* target : {"usaf", "seedling"}) {
    const RunFile file = search(
        "sim:distance=1900,seed=7,start=350,rate=60,target=" + std::string(target), GetParam());
    EXPECT_EQ(verdict_of(file).result, FocusResult::no_focus) << target;
  }
}

TEST_P(FirstPicture, ShowsThatStepsWereLostOnTheFirstWay) {
  for (const int start : {550, 900}) {
    const std::string rig = "sim:distance=1900,seed=7,lose=45,start=" + std::to_string(start);
    EXPECT_NE(verdict_of(search(rig, GetParam())).result, FocusResult::focused) << rig;
  }
}

TEST_P(FirstPicture, IsKeptAndComputedWithAgain) {
  const RunFile file = search("sim:distance=1900,seed=7,start=350,rate=60", GetParam());
  const RunFile read = RunFile::parse(file.json(), "the run");
  EXPECT_EQ(read.runs.back().first_look, file.runs.back().first_look);
  EXPECT_TRUE(same_answer(read, rerun(read, "the run")));
}

INSTANTIATE_TEST_SUITE_P(Searches, FirstPicture,
                         testing::Values(SearchMethod::automatic, SearchMethod::coarse));

}  // namespace
}  // namespace fathom::test
