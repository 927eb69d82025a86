// SPDX-License-Identifier: Apache-2.0
#include "engine/frame.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <numeric>

#include "engine/error.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

using Pixels = std::vector<std::uint8_t>;

Frame counting(int width, int height) {
  std::vector<std::uint16_t> pixels(static_cast<std::size_t>(width) * height);
  std::iota(pixels.begin(), pixels.end(), std::uint16_t{1000});
  return Frame(width, height, std::move(pixels));
}

TEST(Frame, OwnsItsPixels) {
  const Frame small(3, 2, std::vector<std::uint8_t>{1, 2, 3, 4, 5, 255});
  EXPECT_EQ(small.width_px(), 3);
  EXPECT_EQ(small.height_px(), 2);
  EXPECT_EQ(small.depth(), Depth::bits8);
  EXPECT_EQ(small.stride_bytes(), 3U);
  EXPECT_EQ(small.at(2, 1), 255U);
  const Frame deep(1, 2, std::vector<std::uint16_t>{1, 65535});
  EXPECT_EQ(deep.depth(), Depth::bits16);
  EXPECT_EQ(deep.stride_bytes(), 2U);
  EXPECT_EQ(deep.at(0, 1), 65535U);
  EXPECT_TRUE(Frame().empty());
  EXPECT_FALSE(deep.empty());
}

TEST(Frame, RefusesShapesThatDoNotMatch) {
  expect_error(ErrorCode::bad_argument, [] { Frame(3, 2, Pixels(5)); }, {"6", "5"});
  expect_error(ErrorCode::bad_argument, [] { Frame(0, 2, Pixels()); });
  expect_error(ErrorCode::bad_argument, [] { Frame(-1, -1, Pixels(1)); });
  const std::array<std::uint8_t, 64> buffer{};
  const auto view = [&](const void* at, int width, int height, Depth depth, std::size_t stride) {
    expect_error(ErrorCode::bad_argument, [&] { Frame::view(at, width, height, depth, stride); });
  };
  view(nullptr, 8, 8, Depth::bits8, 8);
  view(buffer.data(), 0, 8, Depth::bits8, 8);
  view(buffer.data(), 8, -8, Depth::bits8, 8);
  view(buffer.data(), 8, 8, Depth::bits8, 7);
  view(buffer.data(), 4, 8, Depth::bits16, 7);
}

TEST(Frame, ViewsRowsAnyNumberOfBytesApart) {
  std::array<unsigned char, 1 + 3 * 7> buffer{};
  const std::uint16_t value = 0xABCD;
  std::memcpy(&buffer[1 + 2 * 7 + 2], &value, 2);  // column 1 of row 2, on an odd address
  const Frame frame = Frame::view(&buffer[1], 3, 3, Depth::bits16, 7);
  EXPECT_EQ(frame.at(1, 2), 0xABCDU);
  EXPECT_EQ(frame.at(0, 0), 0U);
  EXPECT_EQ(frame.stride_bytes(), 7U);
  EXPECT_EQ(static_cast<const void*>(frame.row(2)), &buffer[1 + 14]) << "nothing is copied";
}

TEST(Frame, CloneIsPackedAndIndependent) {
  std::array<std::uint8_t, 12> buffer = {1, 2, 9, 9, 3, 4, 9, 9, 5, 6, 9, 9};
  Frame view = Frame::view(buffer.data(), 2, 3, Depth::bits8, 4);
  view.exposure = {5, 7};
  view.lens_position = 12.5;
  const Frame copy = view.clone();
  buffer.fill(0);
  EXPECT_EQ(copy.stride_bytes(), 2U);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 2; ++x) EXPECT_EQ(copy.at(x, y), static_cast<unsigned>(2 * y + x + 1));
  }
  EXPECT_EQ(copy.exposure.start_ns, 5);
  EXPECT_EQ(copy.exposure.end_ns, 7);
  EXPECT_EQ(copy.lens_position, 12.5);
  EXPECT_TRUE(Frame().clone().empty());
}

TEST(Frame, HoldsTheOwnerOfItsBufferAndLetsGoOfIt) {
  auto buffer = std::make_shared<Pixels>(Pixels{1, 2, 9, 3, 4, 9});
  const std::weak_ptr<Pixels> watched = buffer;
  Frame frame = Frame::view(buffer->data(), 2, 2, Depth::bits8, 3, buffer);
  EXPECT_EQ(static_cast<const void*>(frame.row(0)), buffer->data()) << "nothing is copied";
  buffer.reset();
  ASSERT_FALSE(watched.expired());
  Frame moved = std::move(frame);
  EXPECT_EQ(moved.at(1, 1), 4U);
  EXPECT_EQ(watched.use_count(), 1) << "the frame that was moved from holds nothing";
  const Frame copy = moved.clone();
  moved = counting(5, 4);
  EXPECT_TRUE(watched.expired());
  EXPECT_EQ(copy.at(1, 1), 4U);
}

TEST(Frame, HoldsNoOwnerOfWhatItRefuses) {
  const auto buffer = std::make_shared<Pixels>(Pixels{1, 2, 3, 4});
  expect_error(ErrorCode::bad_argument,
               [&] { Frame::view(buffer->data(), 2, 2, Depth::bits8, 2, nullptr); }, {"owner"});
  expect_error(ErrorCode::bad_argument,
               [&] { Frame::view(buffer->data(), 2, 2, Depth::bits8, 1, buffer); }, {"stride"});
  EXPECT_EQ(buffer.use_count(), 1);
}

TEST(Frame, MovesWithItsPixels) {
  Frame first = counting(5, 4);
  first.lens_position = 3;
  const auto* const pixels = first.row(0);
  Frame second = std::move(first);
  EXPECT_TRUE(first.empty());  // NOLINT(bugprone-use-after-move): the moved-from state is promised
  EXPECT_EQ(first.width_px(), 0);
  EXPECT_EQ(second.row(0), pixels);
  EXPECT_EQ(second.at(4, 3), 1019U);
  EXPECT_EQ(second.lens_position, 3);
  Frame third = counting(2, 2);
  third = std::move(second);
  EXPECT_EQ(third.at(4, 3), 1019U);
  Frame& same = third;
  third = std::move(same);
  EXPECT_EQ(third.at(4, 3), 1019U) << "moved onto itself";
}

Frame average(const std::vector<Frame>& frames) {
  FrameAverage average;
  for (const Frame& frame : frames) average.add(frame);
  return average.mean();
}

TEST(Average, RoundsToTheNearestGreyLevel) {
  std::vector<Frame> frames;
  for (const int value : {10, 11, 11, 13}) {
    frames.push_back(Frame(2, 1, std::vector<std::uint8_t>{static_cast<std::uint8_t>(value), 255}));
  }
  frames[0].exposure = {100, 200};
  frames[0].lens_position = 7;
  frames[3].exposure = {400, 500};
  const Frame mean = average(frames);
  EXPECT_EQ(mean.at(0, 0), 11U);  // 45 / 4 = 11.25
  EXPECT_EQ(mean.at(1, 0), 255U);
  EXPECT_EQ(mean.depth(), Depth::bits8);
  EXPECT_EQ(mean.exposure.start_ns, 100);
  EXPECT_EQ(mean.exposure.end_ns, 500);
  EXPECT_EQ(mean.lens_position, 7);

  std::vector<Frame> pair;
  pair.push_back(Frame(1, 1, std::vector<std::uint16_t>{65534}));
  pair.push_back(Frame(1, 1, std::vector<std::uint16_t>{65535}));
  EXPECT_EQ(average(pair).at(0, 0), 65535U) << "half rounds up";
}

TEST(Average, RefusesWhatHasNoMean) {
  expect_error(ErrorCode::bad_argument, [] { average({}); });
  std::vector<Frame> frames;
  frames.push_back(counting(3, 2));
  frames.push_back(counting(2, 3));
  expect_error(ErrorCode::bad_argument, [&] { average(frames); });
  frames[1] = Frame(3, 2, std::vector<std::uint8_t>(6));
  expect_error(ErrorCode::bad_argument, [&] { average(frames); });
}

}  // namespace
}  // namespace fathom
