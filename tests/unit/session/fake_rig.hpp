// SPDX-License-Identifier: Apache-2.0
// A rig whose parts fail on purpose, in a world that a test can look at.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/error.hpp"
#include "session/rig.hpp"

namespace fathom::test {

/// What may be wrong with the rig.
struct Faults {
  double stuck_at = -1;         ///< From here on the lens does not follow, and says so.
  double encoder_error = 0;     ///< How far off the reported position is.
  bool freezes = false;         ///< Every picture is the first one, newly stamped.
  bool freezes_stamps = false;  ///< Nor are they newly stamped.
  int lost_after = -1;          ///< Frames until the camera is unplugged.
  int gain = 100;               ///< Percent; saturates well above.
  int queued = 0;               ///< Pictures of where the lens stood first, taken then.
  int drops_each = 0;           ///< Frames lost before each one that is given out.
  bool is_recorded = false;     ///< No live camera: a frame taken twice is the same.
  std::string note = {};        ///< What the lens says of every move.
  int stays_after = -1;         ///< Moves until the lens takes no more.
  int step_ns = 0;              ///< Of a lens that can be watched, for each step; 0: it cannot be.
  double fails_at = -1;         ///< Where its motor fails on the way.
};

/// A travel that is watched.
struct Way {
  double from = 0, to = 0;
  std::int64_t started_ns = 0;
  int step_ns = 1;

  double at(std::int64_t time_ns) const {
    const double gone = static_cast<double>(time_ns - started_ns) / step_ns;
    return std::clamp(from + gone, from, to);
  }
  std::int64_t ended_ns() const {
    return started_ns + static_cast<std::int64_t>(to - from) * step_ns;
  }
};

/// Lens, camera and clock. The sharper the picture, the stronger its stripes: a Lorentzian at 60.
struct World {
  Faults faults;
  double position = 7;
  std::int64_t clock_ns = 0;
  int frames = 0;
  std::vector<double> moves;  ///< Where the lens was sent.
  std::optional<Way> way;     ///< The last travel that was watched.
  bool is_moving = false;     ///< While its Motion lives.
};

class FakeMotion final : public Motion {
 public:
  explicit FakeMotion(World& world) : world_(world) { world_.is_moving = true; }
  ~FakeMotion() override {
    world_.position = way().at(world_.clock_ns);
    world_.is_moving = false;
  }
  void stop() override {}
  std::optional<Arrival> arrived() override {
    if (has_failed(world_.clock_ns)) return wait();
    if (world_.clock_ns < way().ended_ns()) return std::nullopt;
    return wait();
  }
  Arrival wait() override {
    if (has_failed(world_.clock_ns)) throw Error(ErrorCode::device_lost, "fake motor: it burns");
    return {.position = way().to,
            .started_ns = way().started_ns,
            .stopped_ns = way().ended_ns(),
            .settled_ns = way().ended_ns()};
  }

 private:
  const Way& way() const { return *world_.way; }
  bool has_failed(std::int64_t time_ns) const {
    return world_.faults.fails_at >= 0 && way().at(time_ns) >= world_.faults.fails_at;
  }
  Where do_during(const Exposure& exposure) const override {
    if (exposure.end_ns > world_.clock_ns) throw Error(ErrorCode::bad_argument, "in the future");
    if (has_failed(exposure.end_ns)) throw Error(ErrorCode::unavailable, "after the end");
    const double low = way().at(exposure.start_ns), high = way().at(exposure.end_ns);
    return {.position = (low + high) / 2, .sigma = 0.25, .smear = high - low};
  }

  World& world_;
};

class FakeLens final : public Lens {
 public:
  explicit FakeLens(World& world) : world_(world) {}
  LensInfo info() const override { return {"fake lens", "steps", 0, 100, 1, 10, {}}; }
  double position() const override { return world_.position; }
  Arrival move_to(double wanted) override {
    require_within(info(), wanted);
    const int most = world_.faults.stays_after;
    if (most >= 0 && static_cast<int>(world_.moves.size()) >= most)
      throw Error(ErrorCode::device_lost, "fake lens: it was unplugged");
    world_.moves.push_back(wanted);
    const double goal = nearest(wanted);
    const bool stuck = world_.faults.stuck_at >= 0 && goal > world_.faults.stuck_at;
    world_.position = stuck ? world_.faults.stuck_at : goal;
    const std::int64_t start = world_.clock_ns;
    world_.clock_ns += 3000;
    return {.position = world_.position + world_.faults.encoder_error,
            .started_ns = start,
            .stopped_ns = start + 2000,
            .settled_ns = world_.clock_ns,
            .note = world_.faults.note};
  }
  Arrival home() override { return move_to(0); }
  std::string why_unwatched() const override {
    return world_.faults.step_ns > 0 ? std::string() : Lens::why_unwatched();
  }
  std::unique_ptr<Motion> start(double wanted) override {
    if (!can_be_watched()) return Lens::start(wanted);
    world_.way = Way{world_.position, wanted, world_.clock_ns, world_.faults.step_ns};
    return std::make_unique<FakeMotion>(world_);
  }

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
  bool is_live() const override { return !world_.faults.is_recorded; }
  FrameCounts counts() const override {
    const auto given = static_cast<std::uint64_t>(world_.frames);
    return {given, given * world_.faults.drops_each, 0};
  }
  std::optional<Frame> grab(std::chrono::milliseconds) override {
    const Faults& faults = world_.faults;
    if (faults.lost_after >= 0 && world_.frames >= faults.lost_after)
      throw Error(ErrorCode::device_lost, "fake camera: it was unplugged");
    if (++world_.frames == 1 || !faults.freezes) seen_at_ = world_.position;
    const bool is_old = world_.frames <= faults.queued;
    if (is_old) seen_at_ = 7;
    world_.clock_ns += 10;
    if (world_.is_moving) seen_at_ = world_.way->at(world_.clock_ns - 5);
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
    if (world_.is_moving) frame.exposure = {world_.clock_ns - 10, world_.clock_ns};
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

}  // namespace fathom::test
