// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/verdict_words.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace fathom::cli {
namespace {

Verdict verdict_of(Why why) {
  Verdict verdict;
  verdict.rise = {.contrast = 0.5, .rise = 12.34, .needed = 5.67};
  verdict.reason = {.why = why,
                    .position = 740.25,
                    .r_squared = 0.321,
                    .confidence = 0.111,
                    .second_position = 512.5,
                    .second_part = 0.6,
                    .evaluations = 9,
                    .dead = 7};
  return verdict;
}

TEST(WordsFor, SayEachReasonInOneLineOfItsOwn) {
  std::set<std::string> seen;
  for (const Why why : kWhys) {
    const std::string words = words_for(verdict_of(why));
    EXPECT_FALSE(words.empty()) << to_string(why);
    EXPECT_EQ(words.find('\n'), std::string::npos) << words;
    EXPECT_FALSE(words.ends_with('.')) << words;
    EXPECT_TRUE(seen.insert(words).second) << words;
  }
}

TEST(WordsFor, HoldTheNumbers) {
  const std::pair<Why, std::vector<const char*>> expected[] = {
      {Why::stands_out, {"12 times"}},
      {Why::dead_pictures, {"7 of 9", "exposure"}},
      {Why::within_noise, {"12.3 times", "5.7"}},
      {Why::no_shape, {"740.25", "R^2 = 0.32", "--average"}},
      {Why::unsure, {"740.25", "confidence 0.11"}},
      {Why::at_end, {"740.25", "--bracket"}},
      {Why::two_peaks, {"740.25", "60 %", "512.5", "--window"}}};
  for (const auto& [why, texts] : expected) {
    const std::string words = words_for(verdict_of(why));
    for (const char* text : texts) EXPECT_NE(words.find(text), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace fathom::cli
