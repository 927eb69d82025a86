// SPDX-License-Identifier: Apache-2.0
// A map of depth that grows in a terminal, by its letters.
#include "tools/fathom/depth/growing_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fathom::cli {
namespace {

/// 40 x 20 places; the left half is sharpest in frame 2, the right one in frame 7, the lowest
/// quarter nowhere.
CurveGrid curves_of(int frames) {
  CurveGrid curves{.columns = 40, .rows = 20, .frames = {}};
  for (int z = 0; z < frames; ++z) {
    std::vector<float> energies;
    for (int y = 0; y < curves.rows; ++y) {
      for (int x = 0; x < curves.columns; ++x) {
        const float away = static_cast<float>(z - (x < 20 ? 2 : 7));
        energies.push_back(y >= 15 ? 4.0f : 4.0f + 40 * std::exp(-away * away));
      }
    }
    curves.frames.push_back(energies);
  }
  return curves;
}

TEST(GrowingRows, TellWhereEachBlockIsSharpestUntilNow) {
  const auto all = growing_rows(curves_of(10), 20, 20);
  ASSERT_EQ(all.size(), 5u);  // Letters are twice as high as wide.
  EXPECT_EQ(all[0], "00000000009999999999");
  EXPECT_EQ(all[4], "....................");
  EXPECT_EQ(growing_rows(curves_of(2), 20, 20)[0], "....................");
  // The right half is yet to come.
  EXPECT_EQ(growing_rows(curves_of(5), 20, 20)[0], "0000000000..........");
}

TEST(GrowingRows, FitWhatTheTerminalHas) {
  for (const int columns : {1, 3, 20, 40, 500}) {
    for (const int rows : {1, 2, 10, 500}) {
      const auto lines = growing_rows(curves_of(10), columns, rows);
      EXPECT_LE(static_cast<int>(lines.size()), rows);
      ASSERT_FALSE(lines.empty());
      for (const std::string& line : lines) {
        EXPECT_LE(static_cast<int>(line.size()), columns);
        EXPECT_EQ(line.size(), lines[0].size());
      }
    }
  }
  EXPECT_TRUE(growing_rows({.columns = 4, .rows = 4, .frames = {}}, 4, 4)[0] == "....");
}

TEST(GrowingRows, AreColouredDigitByDigit) {
  const std::string text = coloured_digits("0.9");
  EXPECT_EQ(text.rfind("\033[38;5;", 0), 0u);
  EXPECT_NE(text.find("\033[0m."), std::string::npos);
  EXPECT_EQ(text.substr(text.size() - 5), "9\033[0m");
}

}  // namespace
}  // namespace fathom::cli
