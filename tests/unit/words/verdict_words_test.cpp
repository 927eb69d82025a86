// SPDX-License-Identifier: Apache-2.0
#include "words/verdict_words.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "words/warning_words.hpp"

namespace fathom {
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
      {Why::no_shape, {"740.25", "R^2 = 0.32", "walsh-sequency"}},
      {Why::unsure, {"740.25", "confidence 0.11"}},
      {Why::at_end, {"740.25", "--bracket"}},
      {Why::two_peaks, {"740.25", "60 %", "512.5", "--window"}}};
  for (const auto& [why, texts] : expected) {
    const std::string words = words_for(verdict_of(why));
    for (const char* text : texts) EXPECT_NE(words.find(text), std::string::npos) << words;
  }
}

/// Whether the words for a reason have a text in them.
bool say(const Reason& reason, const char* text) {
  Verdict verdict;
  verdict.reason = reason;
  return words_for(verdict).find(text) != std::string::npos;
}

TEST(WordsFor, AdviseWhatCanBeDone) {
  Reason reason{.why = Why::within_noise, .is_live = true};
  for (const char* advice : {"search elsewhere", "better light", "a larger window"})
    EXPECT_TRUE(say(reason, advice)) << advice;
  reason.whole_travel = reason.largest_window = true;
  reason.saturated = 0.1;
  for (const char* advice : {"search elsewhere", "better light", "a larger window"})
    EXPECT_FALSE(say(reason, advice)) << advice;
  EXPECT_TRUE(say(reason, "try a shorter exposure, a larger --average, or a target with"));
  reason.is_live = false;
  EXPECT_TRUE(say(reason, "try pictures with more edges"));
  EXPECT_FALSE(say({.why = Why::too_wild, .largest_window = true}, "larger window"));
  EXPECT_FALSE(say({.why = Why::too_faint, .is_live = true, .saturated = 0.1}, "better light"));
  EXPECT_FALSE(say({.why = Why::one_position, .whole_travel = true}, "--bracket"));
  EXPECT_FALSE(say({.why = Why::dead_pictures}, "set the exposure")) << "of a recording";
}

TEST(WordsFor, ACurveThatALensInMotionMayHaveMadeNameTheCheck) {
  EXPECT_TRUE(say({.why = Why::two_peaks, .is_live = true}, "rigs check"));
  EXPECT_TRUE(say({.why = Why::changed, .is_live = true}, "rigs check"));
  EXPECT_FALSE(say({.why = Why::two_peaks}, "rigs check"));
}

constexpr Terms kOthers = {.average = "AVERAGE",
                           .window = "WINDOW",
                           .ends = "ENDS",
                           .wider = "WIDER",
                           .metric_before = "METRIC(",
                           .metric_after = ")",
                           .settling_check = ""};

TEST(WordsFor, NameNoOptionWhereTheReaderHasOtherTerms) {
  for (const Why why : kWhys) {
    for (const bool is_live : {false, true}) {
      Verdict verdict = verdict_of(why);
      verdict.reason.is_live = is_live;
      const std::string words = words_for(verdict, kOthers);
      EXPECT_EQ(words.find("--"), std::string::npos) << words;
      EXPECT_EQ(words.find("rigs check"), std::string::npos) << words;
    }
  }
  EXPECT_NE(words_for(verdict_of(Why::no_shape), kOthers).find("METRIC(walsh-sequency)"),
            std::string::npos);
  EXPECT_NE(words_for(verdict_of(Why::two_peaks), kOthers).find("WINDOW, or ENDS"),
            std::string::npos);
}

TEST(LinesOf, NameTheWindowAsTheReaderDoes) {
  const Receding receding = {.from = 3, .to = 5, .spread = 1, .unit = "um"};
  EXPECT_NE(lines_of(receding).at(0).find("--window"), std::string::npos);
  EXPECT_NE(lines_of(receding, kOthers).at(0).find("a smaller WINDOW on"), std::string::npos);
}

}  // namespace
}  // namespace fathom
