// SPDX-License-Identifier: Apache-2.0
// The timing rules of a measurement, on a camera and a lens that break them on purpose.
#include "session/shot.hpp"

#include <gtest/gtest.h>

#include <deque>

#include "engine/error.hpp"

namespace fathom {
namespace {

class FakeCamera final : public Camera {
 public:
  std::string description() const override { return "fake camera"; }
  CameraSettings settings() const override { return {8, 8, Depth::bits8, 0}; }
  Validity validate(CameraSettings&) const override { return Validity::valid; }
  void apply(const CameraSettings&) override {}
  bool is_live() const override { return true; }
  std::optional<Frame> grab(std::chrono::milliseconds) override {
    ++grabs;
    if (queue.empty()) return std::nullopt;
    Frame frame = std::move(queue.front());
    queue.pop_front();
    return frame;
  }

  void expect(std::int64_t start_ns, std::uint8_t grey, int side = 8) {
    Frame frame(side, side, std::vector<std::uint8_t>(static_cast<std::size_t>(side) * side, grey));
    frame.exposure = {start_ns, start_ns + 10};
    queue.push_back(std::move(frame));
  }

  std::deque<Frame> queue;
  int grabs = 0;
};

class FakeLens final : public Lens {
 public:
  explicit FakeLens(double position = 7) : position_(position) {}
  LensInfo info() const override { return {"fake lens", "steps", 0, 100, 1, 10, {}}; }
  double position() const override { return position_; }
  Arrival move_to(double position) override {
    require_within(info(), position);
    if (is_blocked) throw Error(ErrorCode::device_lost, "fake lens: it is blocked");
    position_ = position;
    return {.position = position, .settled_ns = 1000};
  }
  Arrival home() override { return move_to(0); }

  bool is_blocked = false;

 private:
  double position_;
};

TEST(Shoot, DropsFramesThatBeganBeforeTheLensHadSettled) {
  FakeCamera camera;
  FakeLens lens;
  camera.expect(900, 1);
  camera.expect(999, 2);
  camera.expect(1000, 3);
  const Shot shot = shoot(camera, lens, 50, {});
  EXPECT_EQ(shot.frame.at(0, 0), 3u);
  EXPECT_EQ(shot.arrival.position, 50);
  EXPECT_EQ(shot.arrival.settled_ns, 1000);
}

TEST(Shoot, AveragesAsManyFramesAsAskedFor) {
  FakeCamera camera;
  FakeLens lens;
  camera.expect(500, 250);  // stale
  for (const std::uint8_t grey : std::initializer_list<std::uint8_t>{10, 20, 60})
    camera.expect(1000 + grey, grey);
  ShotOptions options;
  options.average = 3;
  const Shot shot = shoot(camera, lens, 50, options);
  EXPECT_EQ(shot.frame.at(3, 3), 30u);
  EXPECT_EQ(shot.frame.exposure.start_ns, 1010);
  EXPECT_EQ(shot.frame.exposure.end_ns, 1070);
}

ErrorCode code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorCode::io;
}

TEST(Shoot, SaysSoWhenNoFrameComes) {
  FakeCamera camera;
  FakeLens lens;
  EXPECT_EQ(code_of([&] { shoot(camera, lens, 50, {}); }), ErrorCode::timeout);
}

TEST(Shoot, GivesUpOnACameraThatOnlySendsOldFrames) {
  FakeCamera camera;
  FakeLens lens;
  for (int i = 0; i < 2000; ++i) camera.expect(i % 1000, 1);
  EXPECT_EQ(code_of([&] { shoot(camera, lens, 50, {}); }), ErrorCode::timeout);
  EXPECT_LE(camera.grabs, 1000);
}

TEST(Shoot, RefusesAFrameOfAnotherSize) {
  FakeCamera camera;
  FakeLens lens;
  camera.expect(2000, 1, 16);
  EXPECT_EQ(code_of([&] { shoot(camera, lens, 50, {}); }), ErrorCode::bad_data);
}

TEST(Shoot, StopsBeforeMovingWhenAsked) {
  FakeCamera camera;
  FakeLens lens;
  camera.expect(2000, 1);
  ShotOptions options;
  options.stop_requests = [] { return 1; };
  EXPECT_EQ(code_of([&] { shoot(camera, lens, 50, options); }), ErrorCode::cancelled);
  EXPECT_EQ(lens.position(), 7);
}

TEST(Shoot, DoesNotMoveBeyondTheTravel) {
  FakeCamera camera;
  FakeLens lens;
  EXPECT_EQ(code_of([&] { shoot(camera, lens, 101, {}); }), ErrorCode::out_of_bounds);
  EXPECT_EQ(camera.grabs, 0);
}

TEST(LensReturn, PutsTheLensBackAlsoAfterAFailure) {
  FakeCamera camera;
  FakeLens lens;
  try {
    LensReturn put_back(lens);
    shoot(camera, lens, 50, {});
  } catch (const Error&) {
  }
  EXPECT_EQ(lens.position(), 7);
}

TEST(LensReturn, OfALensFoundBeyondItsTravelIsTheNearestPlace) {
  FakeLens lens(130);
  {
    const LensReturn put_back(lens);
    lens.move_to(50);
  }
  EXPECT_EQ(lens.position(), 100);
}

TEST(LensReturn, SaysWhyTheLensIsNotWhereItWas) {
  FakeLens lens;
  struct Listener final : Observer {
    std::optional<LensNotReturned> told;
    void warned(const Warning& warning) override { told = std::get<LensNotReturned>(warning); }
  } listener;
  {
    const LensReturn put_back(lens, listener);
    lens.move_to(50);
    lens.is_blocked = true;
  }
  ASSERT_TRUE(listener.told);
  EXPECT_EQ(listener.told->position, 7);
  EXPECT_NE(listener.told->why.find("blocked"), std::string::npos) << listener.told->why;
}

TEST(LensReturn, LeavesTheLensWhereItIsWhenReleased) {
  FakeLens lens;
  {
    LensReturn put_back(lens);
    lens.move_to(60);
    put_back.release();
  }
  EXPECT_EQ(lens.position(), 60);
}

}  // namespace
}  // namespace fathom
