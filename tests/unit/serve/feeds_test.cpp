// SPDX-License-Identifier: Apache-2.0
// Whoever tells never waits, whatever readers do.
#include <gtest/gtest.h>

#include <thread>

#include "serve/base64.hpp"
#include "serve/event_feed.hpp"
#include "serve/picture_feed.hpp"

namespace fathom::serve {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kNow{0};
constexpr milliseconds kLong{10'000};

Frame grey_frame(int width, int height, std::uint8_t grey) {
  return Frame(width, height,
               std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height, grey));
}

TEST(EventFeed, GivesEveryEventInOrder) {
  EventFeed feed;
  feed.tell("score", "1");
  feed.tell("state", "2");
  const auto events = feed.read(1, kNow);
  ASSERT_TRUE(events);
  ASSERT_EQ(events->size(), 2u);
  EXPECT_EQ((*events)[0].id, 1u);
  EXPECT_EQ((*events)[0].kind, "score");
  EXPECT_EQ((*events)[1].data, "2");
  EXPECT_TRUE(feed.read(3, kNow)->empty());
}

TEST(EventFeed, AReaderThatIsTooSlowIsToldSoAndCostsNoMemory) {
  EventFeed feed(4, 100);
  for (int i = 0; i < 6; ++i) feed.tell("score", "x");
  EXPECT_FALSE(feed.read(1, kNow));
  EXPECT_EQ(feed.read(3, kNow)->size(), 4u);
  feed.tell("spectrum", std::string(99, 'x'));
  EXPECT_EQ(feed.read(feed.next() - 1, kNow)->size(), 1u);
  EXPECT_FALSE(feed.read(feed.next() - 3, kNow));
}

TEST(EventFeed, WakesAReaderThatWaitsAndLetsGoWhenItCloses) {
  EventFeed feed;
  std::thread teller([&] { feed.tell("score", "1"); });
  EXPECT_EQ(feed.read(1, kLong)->size(), 1u);
  teller.join();
  std::thread closer([&] { feed.close(); });
  EXPECT_TRUE(feed.read(2, kLong)->empty());
  closer.join();
}

TEST(PictureFeed, AStuckWatcherMissesPicturesAndHoldsUpNobody) {
  PictureFeed feed;
  const int pictures = 1000;
  std::shared_ptr<const Picture> stuck;
  for (int i = 0; i < pictures; ++i) {
    feed.show(grey_frame(8, 8, static_cast<std::uint8_t>(i % 256)), i, true, 255);
    if (i == 0) stuck = feed.next(0, kNow);  // it never asks again
  }
  const auto newest = feed.next(stuck->number(), kNow);
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->number(), static_cast<std::uint64_t>(pictures));
  EXPECT_EQ(stuck->frame().at(0, 0), 0u);  // what it looks at stays
  EXPECT_FALSE(feed.next(newest->number(), kNow));
}

TEST(PictureFeed, EncodesOnceForAllOfAWidth) {
  PictureFeed feed;
  feed.show(grey_frame(64, 32, 100), 5, true, 255);
  const auto picture = feed.newest();
  EXPECT_EQ(picture->jpeg(0), picture->jpeg(64));
  EXPECT_EQ(picture->jpeg(30), picture->jpeg(22));  // a third of the width each
  EXPECT_NE(picture->jpeg(0), picture->jpeg(30));
  EXPECT_EQ(picture->jpeg(1)->substr(0, 2), "\xff\xd8");
}

TEST(PictureFeed, WaitersAreLetGoWhenItCloses) {
  PictureFeed feed;
  std::thread closer([&] { feed.close(); });
  EXPECT_FALSE(feed.next(0, kLong));
  closer.join();
}

TEST(Base64, IsThatOfTheStandard) {
  const auto of = [](std::string_view text) {
    return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");  // RFC 4648, section 10
  EXPECT_EQ(of("\xff\xff\xfe"), "///+");
}

}  // namespace
}  // namespace fathom::serve
