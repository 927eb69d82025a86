// SPDX-License-Identifier: Apache-2.0
#include "engine/findings.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/engine/fake_devices.hpp"

namespace fathom {
namespace {

class FindingsTest : public ::testing::Test {
 protected:
  void SetUp() override { setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1); }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }

  /// As the next process finds them.
  Findings findings(const char* key = "driver 1") { return {"findings", key, clock_}; }
  std::optional<std::size_t> known() { return findings().known("metric"); }
  void learn(std::size_t value, bool is_certain = true) {
    EXPECT_EQ(findings().learn("metric", {value, is_certain}, std::equal_to<>()), value);
  }

  test::TemporaryFolder folder_;
  test::FakeClock clock_;
};

TEST_F(FindingsTest, AreUsedForAWhileAndThenConfirmed) {
  EXPECT_EQ(known(), std::nullopt);
  learn(64);
  EXPECT_EQ(known(), 64U);
  clock_.pass(kApart_s + 1);
  EXPECT_EQ(known(), std::nullopt) << "one measurement alone is believed for good";
  learn(64);
  clock_.pass(kOld_s - 10);
  EXPECT_EQ(known(), 64U);
  clock_.pass(20);
  EXPECT_EQ(known(), std::nullopt) << "an old one is believed for ever";
}

TEST_F(FindingsTest, ThatDisagreeStartAgain) {
  learn(64);
  clock_.pass(kApart_s + 1);
  learn(4096);
  EXPECT_EQ(known(), 4096U);
  clock_.pass(kApart_s + 1);
  EXPECT_EQ(known(), std::nullopt);
  learn(4096);
  clock_.pass(kApart_s + 1);
  EXPECT_EQ(known(), 4096U);
}

TEST_F(FindingsTest, ThatAreUncertainConfirmNothing) {
  learn(64, false);
  clock_.pass(kApart_s + 1);
  learn(64);
  clock_.pass(kApart_s + 1);
  EXPECT_EQ(known(), std::nullopt) << "confirmed by an uncertain one";
  learn(64, false);
  clock_.pass(kApart_s + 1);
  EXPECT_EQ(known(), std::nullopt) << "an uncertain one confirms";
}

TEST_F(FindingsTest, ThatWereConfirmedGiveWayToWhatIsSeen) {
  learn(64);
  clock_.pass(kApart_s + 1);
  learn(64);
  clock_.pass(kOld_s + 1);
  learn(256);
  EXPECT_EQ(known(), 256U);
  clock_.pass(kApart_s + 1);
  EXPECT_EQ(known(), std::nullopt);
}

TEST_F(FindingsTest, OfAnotherKeyAreNone) {
  learn(64);
  EXPECT_EQ(findings("driver 2").known("metric"), std::nullopt);
  EXPECT_EQ(findings().known("another"), std::nullopt);
}

TEST_F(FindingsTest, FromTheFutureAreMeasuredAgain) {
  learn(64);
  clock_.pass(-3600);  // the calendar was set back
  EXPECT_EQ(known(), std::nullopt);
}

}  // namespace
}  // namespace fathom
