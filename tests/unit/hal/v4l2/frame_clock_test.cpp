// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/frame_clock.hpp"

#include <gtest/gtest.h>

namespace fathom::test {
namespace {

using v4l2::Delivery;
using v4l2::FrameClock;
using v4l2::StampKind;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kInterval = 40 * kMs;

/// A frame that was done at a time and taken a millisecond later, from a buffer that waited.
Delivery done_at(std::int64_t stamp_ns, std::uint32_t sequence,
                 StampKind kind = StampKind::last_byte) {
  return {sequence, kind, stamp_ns, stamp_ns - 3 * kInterval, stamp_ns + kMs};
}

TEST(FrameClock, AStampOfTheLastByteIsAfterExposureAndReadout) {
  FrameClock clock(kInterval, 0, 0);
  const Exposure exposure = clock.read(done_at(1000 * kMs, 0), 10 * kMs);
  EXPECT_EQ(exposure.start_ns, (1000 - 40 - 10) * kMs);
  EXPECT_EQ(exposure.end_ns, 1000 * kMs);
}

TEST(FrameClock, AStampOfTheFirstByteIsAfterTheExposure) {
  FrameClock clock(kInterval, 0, 0);
  EXPECT_EQ(clock.read(done_at(1000 * kMs, 0, StampKind::first_byte), 10 * kMs).start_ns,
            (1000 - 10) * kMs);
}

TEST(FrameClock, AStampOfTheExposureIsItsStart) {
  FrameClock clock(kInterval, 0, 0);
  const Exposure exposure = clock.read(done_at(1000 * kMs, 0, StampKind::exposure), 10 * kMs);
  EXPECT_EQ(exposure.start_ns, 1000 * kMs);
  EXPECT_EQ(exposure.end_ns, 1010 * kMs);
}

TEST(FrameClock, AnExposureThatNobodyKnowsLastsAnInterval) {
  FrameClock clock(kInterval, 0, 0);
  EXPECT_EQ(clock.read(done_at(1000 * kMs, 0, StampKind::first_byte), 0).start_ns, 960 * kMs);
}

TEST(FrameClock, FramesOfDelayAreTakenAway) {
  for (const StampKind kind : {StampKind::last_byte, StampKind::first_byte, StampKind::exposure}) {
    FrameClock prompt(kInterval, 0, 0), late(kInterval, 2.5, 0);
    EXPECT_EQ(prompt.read(done_at(1000 * kMs, 0, kind), kMs).start_ns - 100 * kMs,
              late.read(done_at(1000 * kMs, 0, kind), kMs).start_ns);
  }
}

TEST(FrameClock, AStreamSlowerThanItsDriverSaysIsBelievedSlower) {
  FrameClock clock(kInterval, 0, 0);
  clock.read(done_at(1000 * kMs, 0), 0);
  Delivery slow = done_at(1400 * kMs, 2);
  slow.ready_since_ns = 900 * kMs;
  EXPECT_EQ(clock.read(slow, 0).start_ns, (1400 - 2 * 200) * kMs);
}

/// The frame after a move is the one that counts, and the buffers were full all the while.
TEST(FrameClock, AStreamSlowerThanItsDriverSaysIsStillSlowAfterAPause) {
  FrameClock clock(33 * kMs, 0, 0);
  clock.read(done_at(1000 * kMs, 0), 0);
  Delivery next = done_at(1200 * kMs, 1);
  next.ready_since_ns = 900 * kMs;
  clock.read(next, 0);
  Delivery scored = done_at(3000 * kMs, 10);
  scored.ready_since_ns = 2800 * kMs;
  EXPECT_EQ(clock.read(scored, 0).start_ns, (3000 - 2 * 200) * kMs);
}

TEST(FrameClock, AStreamThatIsFastAgainIsFollowed) {
  FrameClock clock(kInterval, 0, 0);
  clock.read(done_at(1000 * kMs, 0), 0);
  Delivery next = done_at(1200 * kMs, 1);
  next.ready_since_ns = 900 * kMs;
  clock.read(next, 0);
  EXPECT_EQ(clock.read(done_at(1240 * kMs, 2), 0).start_ns, (1240 - 2 * 40) * kMs);
}

TEST(FrameClock, FramesComeNoFasterThanTheyAreExposed) {
  FrameClock prompt(33 * kMs, 0, 0), late(33 * kMs, 2, 0);
  EXPECT_EQ(prompt.read(done_at(5000 * kMs, 0), 500 * kMs).start_ns, (5000 - 2 * 500) * kMs);
  EXPECT_EQ(late.read(done_at(5000 * kMs, 0, StampKind::first_byte), 500 * kMs).start_ns,
            (5000 - 3 * 500) * kMs);
}

TEST(FrameClock, WithoutAStampAFrameIsAsOldAsTheLastEmptyQueue) {
  for (const std::int64_t stamp_ns : {0LL, 5000LL * kMs}) {  // none; and of another clock
    FrameClock clock(kInterval, 0, 100 * kMs);
    Delivery delivery =
        done_at(1000 * kMs, 0, stamp_ns == 0 ? StampKind::none : StampKind::exposure);
    delivery.stamp_ns = stamp_ns;
    EXPECT_EQ(clock.read(delivery, 10 * kMs).start_ns, (100 - 40 - 10) * kMs);
    clock.nothing_ready(950 * kMs);
    delivery.sequence = 1;
    EXPECT_EQ(clock.read(delivery, 10 * kMs).start_ns, (950 - 40 - 10) * kMs);
  }
}

TEST(FrameClock, TimesIncreaseThoughStampsStandStill) {
  FrameClock clock(kInterval, 0, 0);
  const Exposure first = clock.read(done_at(1000 * kMs, 0), kMs);
  const Exposure second = clock.read(done_at(1000 * kMs, 1), kMs);
  EXPECT_GT(second.start_ns, first.start_ns);
  EXPECT_GT(second.end_ns, first.end_ns);
  EXPECT_GE(second.end_ns, second.start_ns);
}

TEST(FrameClock, GapsInTheNumbersAreLosses) {
  FrameClock clock(kInterval, 0, 0);
  clock.read(done_at(1000 * kMs, 7), 0);
  EXPECT_EQ(clock.lost(), 0U);
  clock.read(done_at(1040 * kMs, 8), 0);
  EXPECT_EQ(clock.lost(), 0U);
  clock.read(done_at(1160 * kMs, 11), 0);
  EXPECT_EQ(clock.lost(), 2U);
}

TEST(FrameClock, NumbersThatWrapStandStillOrGoBackAreNone) {
  FrameClock clock(kInterval, 0, 0);
  clock.read(done_at(1000 * kMs, 0xffffffffU), 0);
  clock.read(done_at(1040 * kMs, 0), 0);
  clock.read(done_at(1080 * kMs, 0), 0);
  clock.read(done_at(1120 * kMs, 5000), 0);
  const auto lost = clock.lost();
  clock.read(done_at(1160 * kMs, 3), 0);
  EXPECT_EQ(lost, 4999U);
  EXPECT_EQ(clock.lost(), lost);
}

/// All buffers were full from 1000 ms on, and one was given back at 2000 ms.
TEST(FrameClock, WhatPassesWhileNobodyReadsIsNoLoss) {
  FrameClock clock(kInterval, 0, 0);
  clock.read(done_at(1000 * kMs, 3), 0);
  Delivery next = done_at(2040 * kMs, 29);
  next.ready_since_ns = 2000 * kMs;
  clock.read(next, 0);
  EXPECT_EQ(clock.lost(), 0U);
}

TEST(FrameClock, MoreLossThanNobodyReadExplainsIsALoss) {
  FrameClock clock(kInterval, 0, 0);
  clock.read(done_at(1000 * kMs, 3), 0);
  Delivery next = done_at(3000 * kMs, 53);  // 49 missing; one second unread explains 27 at most
  next.ready_since_ns = 2000 * kMs;
  clock.read(next, 0);
  EXPECT_EQ(clock.lost(), 22U);
}

/// As many are excused as the slow stream had time for, not as its driver says.
TEST(FrameClock, APauseOfASlowStreamExcusesFewLosses) {
  FrameClock clock(33 * kMs, 0, 0);
  clock.read(done_at(1000 * kMs, 0), 0);
  Delivery second = done_at(1200 * kMs, 1);
  second.ready_since_ns = 900 * kMs;
  clock.read(second, 0);
  Delivery next = done_at(2600 * kMs, 22);  // 20 missing; one second unread explains 7 at most
  next.ready_since_ns = 2200 * kMs;
  clock.read(next, 0);
  EXPECT_EQ(clock.lost(), 13U);
}

}  // namespace
}  // namespace fathom::test
