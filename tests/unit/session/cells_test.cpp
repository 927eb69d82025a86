// SPDX-License-Identifier: Apache-2.0
#include "session/cells.hpp"

#include <gtest/gtest.h>

#include "tests/support/frames.hpp"

namespace fathom {
namespace {

using test::make_frame;

std::uint32_t sum(const Frame& frame, int left, int top) {
  std::uint32_t sum = 0;
  for (int y = top; y < top + kCellPx; ++y) {
    for (int x = left; x < left + kCellPx; ++x) sum += frame.at(x, y);
  }
  return sum;
}

TEST(Cells, AreSumsRoundTheWindow) {
  const Frame frame = make_frame("random", 16, 400, 330, 1);
  const auto cells = cells_round(frame, {180, 140, 64});  // its middle is 212, 172
  ASSERT_EQ(cells.size(), 256U);
  EXPECT_EQ(cells[0], sum(frame, 212 - 128, 172 - 128));
  EXPECT_EQ(cells[16 + 2], sum(frame, 84 + 32, 44 + 16));
  EXPECT_EQ(cells[255], sum(frame, 84 + 240, 44 + 240));
}

TEST(Cells, StayWithinThePicture) {
  const Frame frame = make_frame("random", 8, 256, 240, 1);
  const auto cells = cells_round(frame, {192, 0, 64});
  ASSERT_EQ(cells.size(), 16U * 15U);
  EXPECT_EQ(cells[0], sum(frame, 0, 0));
  EXPECT_EQ(cells[239], sum(frame, 240, 224));
  EXPECT_TRUE(cells_round(make_frame("random", 8, 15, 40, 1), {0, 0, 8}).empty());
}

}  // namespace
}  // namespace fathom
