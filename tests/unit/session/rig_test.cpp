// SPDX-License-Identifier: Apache-2.0
// A whole search on a rig whose parts fail on purpose: what it says, and where it leaves the lens.
#include "session/rig.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "focus/focus.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

/// What may be wrong with the rig.
struct Faults {
  double stuck_at = -1;         ///< From here on the lens does not follow, and says so.
  double encoder_error = 0;     ///< How far off the reported position is.
  bool freezes = false;         ///< Every picture is the first one, newly stamped.
  bool freezes_stamps = false;  ///< Nor are they newly stamped.
  int lost_after = -1;          ///< Frames until the camera is unplugged.
  int gain = 100;               ///< Percent; saturates well above.
  int queued = 0;               ///< Pictures of where the lens stood first, taken then.
};

/// Lens, camera and clock. The sharper the picture, the stronger its stripes: a Lorentzian at 60.
struct World {
  Faults faults;
  double position = 7;
  std::int64_t clock_ns = 0;
  int frames = 0;
};

class FakeLens final : public Lens {
 public:
  explicit FakeLens(World& world) : world_(world) {}
  LensInfo info() const override { return {"fake lens", "steps", 0, 100, 1, 10, {}}; }
  double position() const override { return world_.position; }
  Arrival move_to(double wanted) override {
    require_within(info(), wanted);
    const double goal = nearest(wanted);
    const bool stuck = world_.faults.stuck_at >= 0 && goal > world_.faults.stuck_at;
    world_.position = stuck ? world_.faults.stuck_at : goal;
    const std::int64_t start = world_.clock_ns;
    world_.clock_ns += 3000;
    return {
        world_.position + world_.faults.encoder_error, world_.clock_ns, {}, start, start + 2000};
  }
  Arrival home() override { return move_to(0); }

 private:
  World& world_;
};

class FakeCamera final : public Camera {
 public:
  explicit FakeCamera(World& world) : world_(world) {}
  std::string description() const override { return "fake camera"; }
  CameraSettings settings() const override { return {16, 16, Depth::bits8, 1}; }
  Validity validate(CameraSettings&) const override { return Validity::valid; }
  void apply(const CameraSettings&) override {}
  bool is_live() const override { return true; }
  std::optional<Frame> grab(std::chrono::milliseconds) override {
    const Faults& faults = world_.faults;
    if (faults.lost_after >= 0 && world_.frames >= faults.lost_after)
      throw Error(ErrorCode::device_lost, "fake camera: it was unplugged");
    if (++world_.frames == 1 || !faults.freezes) seen_at_ = world_.position;
    const bool is_old = world_.frames <= faults.queued;
    if (is_old) seen_at_ = 7;
    world_.clock_ns += 10;
    if (world_.frames == 1 || !faults.freezes_stamps) stamp_ns_ = world_.clock_ns;
    const double z = (seen_at_ - 60) / 8;
    const double stripes = 5 + 45 / (1 + z * z);
    std::vector<std::uint8_t> pixels(16 * 16);
    for (int i = 0; i < 16 * 16; ++i) {
      const double grey = (100 + (i / 2 % 2 == 0 ? stripes : -stripes)) * faults.gain / 100;
      pixels[i] = static_cast<std::uint8_t>(std::min(grey, 255.0));
    }
    Frame frame(16, 16, std::move(pixels));
    frame.exposure = {stamp_ns_, stamp_ns_ + 10};
    if (is_old) frame.exposure = {world_.frames, world_.frames + 1};
    return frame;
  }

 private:
  World& world_;
  double seen_at_ = 0;
  std::int64_t stamp_ns_ = 0;
};

/// A rig in a world that outlives it.
struct Bench {
  World world;
  RigOptions options;

  explicit Bench(const Faults& faults) {
    world.faults = faults;
    options.rig = "fake";
    options.backend = "reference";
    options.metric = "fft:16";
  }
  Rig rig() {
    return Rig(options,
               {std::make_unique<FakeCamera>(world), std::make_unique<FakeLens>(world), {}});
  }
};

/// A search as the program does it, lens put back in the end.
Focus search(Rig& rig, std::vector<Measurement>& log) {
  const LensReturn put_back(rig.lens());
  const FocusLimits limits = resolve_limits({}, rig.lens().info());
  const auto keep = [&](const Measurement& m) { log.push_back(m); };
  const double scatter = rig.repeat_scatter(limits.from, kRepeatFrames);
  return search_focus(rig.objective(keep), limits, rig.spec(), scatter);
}

TEST(RigWithFakes, FindsItsFocusAndGoesBack) {
  Bench bench({});
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  const Focus focus = search(rig, log);
  EXPECT_EQ(focus.result(), FocusResult::focused) << to_string(focus.verdict.reason.why);
  EXPECT_NEAR(focus.position(), 60, 0.5);
  EXPECT_EQ(bench.world.position, 7);
}

/// What waited in the camera's queue while the lens moved is no repeat of what it sees now.
TEST(RigWithFakes, RepeatsOfAStillSceneScatterByNoiseAlone) {
  Bench bench({.queued = 4});
  Rig rig = bench.rig();
  EXPECT_LT(rig.repeat_scatter(60, kRepeatFrames), 1e-12);
  EXPECT_GT(bench.world.frames, kRepeatFrames + 3) << "the old ones were offered";
}

TEST(RigWithFakes, LogsTheTimesOfEveryStep) {
  Bench bench({});
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  search(rig, log);
  for (const Measurement& m : log) {
    EXPECT_EQ(m.stopped_ns - m.started_ns, 2000);
    EXPECT_EQ(m.settled_ns - m.stopped_ns, 1000);
    EXPECT_GE(m.exposure.start_ns, m.settled_ns);
    EXPECT_GT(m.compute_ns, 0);
  }
  const TimeSpent spent = time_spent(log);
  EXPECT_NEAR(spent.moving, 2e-6 * static_cast<double>(log.size()), 1e-12);
  EXPECT_NEAR(spent.settling, 1e-6 * static_cast<double>(log.size()), 1e-12);
}

TEST(RigWithFakes, ALensThatIsBlockedIsAnError) {
  Faults faults;
  faults.stuck_at = 30;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::device_lost, [&] { search(rig, log); },
               {"stands at 30 steps", "sent to 40", "blocked"});
  EXPECT_EQ(log.size(), 4u) << "what was measured is kept: 0, 10, 20, 30";
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, AnEncodersLastDigitIsNone) {
  Faults faults;
  faults.encoder_error = 0.3;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  const Focus focus = search(rig, log);
  EXPECT_EQ(focus.result(), FocusResult::focused);
  ASSERT_EQ(log.size(), focus.evaluations.size());
  // A replay looks for the positions that the search asked for.
  for (std::size_t i = 0; i < log.size(); ++i)
    EXPECT_EQ(log[i].position, focus.evaluations[i].position);
}

TEST(RigWithFakes, PicturesThatNeverChangeAreNoFocus) {
  Faults faults;
  faults.freezes = true;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  const Focus focus = search(rig, log);
  EXPECT_EQ(focus.result(), FocusResult::no_focus);
  EXPECT_EQ(focus.verdict.reason.why, Why::all_alike);
}

TEST(RigWithFakes, ACameraThatRepeatsItsOldFrameTimesOut) {
  Faults faults;
  faults.freezes = faults.freezes_stamps = true;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::timeout, [&] { search(rig, log); }, {"fake camera", "fresh ones"});
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, ACameraThatIsUnpluggedLeavesTheLensSafe) {
  Faults faults;
  faults.lost_after = kRepeatFrames + 6;
  Bench bench(faults);
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::device_lost, [&] { search(rig, log); }, {"unplugged"});
  EXPECT_EQ(log.size(), 6u);
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, StopsOnRequestWithTheLensBack) {
  Bench bench({});
  int asked = 0;
  bench.options.shot.stop_requests = [&] { return ++asked > 20 ? 1 : 0; };
  Rig rig = bench.rig();
  std::vector<Measurement> log;
  expect_error(ErrorCode::cancelled, [&] { search(rig, log); });
  EXPECT_GT(log.size(), 3u);
  EXPECT_EQ(bench.world.position, 7);
}

TEST(RigWithFakes, MeasuresHowMuchOfTheWindowIsSaturated) {
  for (const int gain : {100, 300}) {
    Faults faults;
    faults.gain = gain;
    Bench bench(faults);
    EXPECT_EQ(bench.rig().measure(60).saturated, gain == 100 ? 0 : 0.5);
  }
}

TEST(RigWithFakes, RefusesAnAverageOfNothing) {
  Bench bench({});
  bench.options.shot.average = 0;
  expect_error(ErrorCode::bad_argument, [&] { bench.rig(); }, {"--average"});
}

}  // namespace
}  // namespace fathom
