// SPDX-License-Identifier: Apache-2.0
#include "words/finding_words.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace fathom {
namespace {

TEST(FindingWords, SayWhatWasNoticedInOneLine) {
  const std::pair<Finding, std::vector<const char*>> expected[] = {
      {OrderOfNames{true, 41, "a_0.5.png", "a_20.png"},
       {"41 pictures", "by the numbers", "a_0.5.png to a_20.png"}},
      {OrderOfNames{false, 2, "a.png", "b.png"}, {"letter by letter"}},
      {MissingNumbers{1, "f4.png", "f6.png"}, {"a number is missing", "f4.png and f6.png"}},
      {MissingNumbers{3, "f4.png", "f8.png"}, {"3 numbers are missing"}},
      {SkippedFiles{{{"bmp", 5}}}, {"5 files skipped: bmp"}},
      {SkippedFiles{{{"bmp", 1}, {"pipe", 2}}}, {"3 files skipped: 1 bmp, 2 pipe"}},
      {SkippedPreviews{"s.tif", 1}, {"s.tif: a page is marked"}},
      {SkippedPreviews{"s.tif", 7}, {"7 pages are marked"}},
      {DamagedPages{.file = "s.tif", .first = 6, .count = 2, .whole = 6, .why = "cut"},
       {"s.tif: page 6 and 1 more", "cut", "6 whole pages"}},
      {SamplesAsPictures{"s.tif", 7}, {"7 samples"}},
      {ChosenPlanes{.file = "s.tif",
                    .channel = 1,
                    .channels = 2,
                    .channel_name = "GFP",
                    .time = 3,
                    .times = 4,
                    .planes = 11,
                    .missing = 2,
                    .spacing_um = 0.5},
       {"11 planes", "channel 1 (GFP) of 2", "time 3 of 4", "0.5 um", "2 more"}},
      {ChosenPlanes{.file = "s.tif", .planes = 5, .missing = 1, .why = "page 5: cut"},
       {"5 planes; 1 more is promised and not there (page 5: cut)"}},
      {NamesTwice{9, "f0.jpg", "f0.png"}, {"9 names are there twice", "f0.jpg and f0.png"}},
      {UnnamedPictures{1, "x.png"}, {"a picture in the folder is not named", "x.png"}},
      {UnnamedPictures{3, "x.png"}, {"3 pictures in the folder are"}},
      {DamagedDescription{"s.tif"}, {"s.tif: its OME-XML"}},
      {DrownedColour{'b', 0.12}, {"12 %", "channel=b"}},
      {RepeatedPictures{21, 7}, {"21 pictures at 7 positions", "averaged"}},
      {LibraryWord{"s.tif", "odd tag"}, {"s.tif", "odd tag"}}};
  for (const auto& [finding, texts] : expected) {
    const std::string words = words_for(finding);
    EXPECT_EQ(words.find('\n'), std::string::npos) << words;
    EXPECT_FALSE(words.ends_with('.')) << words;
    for (const char* text : texts) EXPECT_NE(words.find(text), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace fathom
