// SPDX-License-Identifier: Apache-2.0
// Lost packets, a pulled cable, a user who does not want to wait.
#include <atomic>
#include <thread>

#include "hal/clock.hpp"
#include "support.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom::test {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(AravisFaults, AFrameWithoutAllItsPacketsIsCountedAndNeverGivenOut) {
  FakeGige fake;
  std::atomic<int> painted = 0;
  fake.paint([&] {
    const auto grey = static_cast<std::uint8_t>(1 + painted++ % 255);
    return [grey](int, int) { return grey; };
  });
  const Hardware rig = open_camera(gige(",trigger=off,fps=50", ",width=512,height=512"));
  next_frame(*rig.camera);
  fake.lose(0.003);  // of some two hundred packets each
  for (int i = 0; i < 20; ++i) {
    const auto frame = rig.camera->grab(2s);
    if (!frame) continue;
    const std::uint32_t grey = frame->at(0, 0);
    EXPECT_GT(grey, 0u);
    for (int y = 0; y < 512; ++y)
      for (int x = 0; x < 512; x += 16) ASSERT_EQ(frame->at(x, y), grey) << i;
  }
  const FrameCounts counts = rig.camera->counts();
  EXPECT_GT(counts.corrupt + counts.dropped, 0u);
  EXPECT_GT(counts.delivered, 1u);
}

TEST(AravisFaults, ATriggerWhoseFrameGotLostIsGivenAgain) {
  FakeGige fake;
  const Hardware rig = open_camera(gige());
  next_frame(*rig.camera);
  fake.lose(1);
  EXPECT_FALSE(rig.camera->grab(300ms));
  fake.lose(0);
  const std::int64_t asked_ns = monotonic_now_ns();
  const auto frame = rig.camera->grab(10s);
  ASSERT_TRUE(frame);
  EXPECT_LT(monotonic_now_ns() - asked_ns, 8 * kSecond_ns);
  EXPECT_GE(rig.camera->counts().dropped + rig.camera->counts().corrupt, 1u);
}

TEST(AravisFaults, ACameraThatVanishedIsLostUntilItIsOpenedAgain) {
  for (const char* const keys : {"", ",trigger=off,fps=20"}) {
    FakeGige fake;
    {
      const Hardware rig = open_camera(gige(keys));
      next_frame(*rig.camera);
      fake.vanish();
      const std::int64_t pulled_ns = monotonic_now_ns();
      const auto until_lost = [&] {
        while (monotonic_now_ns() < pulled_ns + 20 * kSecond_ns) rig.camera->grab(1s);
      };
      expect_error(ErrorCode::device_lost, until_lost, {"127.0.0.1"});
      const std::int64_t again_ns = monotonic_now_ns();
      expect_error(ErrorCode::device_lost, [&] { rig.camera->grab(1s); });
      EXPECT_LT(monotonic_now_ns() - again_ns, kSecond_ns) << "it is known to be lost";
    }
    FakeGige another;
    EXPECT_FALSE(next_frame(*open_camera(gige(keys)).camera).empty());
  }
}

TEST(AravisFaults, AWishToStopEndsAWait) {
  FakeGige fake;
  std::atomic<int> requests = 0;
  const Hardware rig = open_camera(gige(",trigger=off,fps=0.2"), [&] { return requests.load(); });
  while (rig.camera->grab(100ms)) {
  }
  std::thread user([&] {
    sleep_until_ns(monotonic_now_ns() + 200'000'000);
    ++requests;
  });
  const std::int64_t asked_ns = monotonic_now_ns();
  try {
    while (rig.camera->grab(30s)) {
    }
    ADD_FAILURE() << "it went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
  user.join();
  EXPECT_LT(monotonic_now_ns() - asked_ns, 20 * kSecond_ns);
}

}  // namespace
}  // namespace fathom::test
