// SPDX-License-Identifier: Apache-2.0
// Searches that see pictures on the lens's way, on the simulated rig with parts that fail.
#include "session/moving.hpp"

#include <gtest/gtest.h>

#include "hal/drivers/simulated/thin_lens.hpp"
#include "session/blur_store.hpp"
#include "session/run_keeper.hpp"
#include "session/session.hpp"
#include "tests/support/expect_error.hpp"

namespace fathom {
namespace {

using test::expect_error;

struct Faults {
  int fails_after = -1;       ///< Asked so often whether it has arrived, the motor fails.
  double more_smear = 0;      ///< Than the lens truly makes within an exposure.
  bool is_unplaced = false;   ///< Nobody knows where the lens stood.
  bool is_unwatched = false;  ///< The lens cannot be watched at all.
  std::string shy = "it hides";
};

class FaultyMotion final : public Motion {
 public:
  FaultyMotion(std::unique_ptr<Motion> motion, const Faults& faults)
      : motion_(std::move(motion)), faults_(faults) {}
  void stop() override { motion_->stop(); }
  std::optional<Arrival> arrived() override {
    if (asked_++ == faults_.fails_after) throw Error(ErrorCode::device_lost, "motor: it burns");
    return motion_->arrived();
  }
  Arrival wait() override { return motion_->wait(); }

 private:
  Where do_during(const Exposure& exposure) const override {
    if (faults_.is_unplaced) throw Error(ErrorCode::bad_argument, "nobody knows");
    Where where = motion_->during(exposure);
    where.smear += faults_.more_smear;
    return where;
  }

  std::unique_ptr<Motion> motion_;
  Faults faults_;
  int asked_ = 0;
};

class FaultyLens final : public Lens {
 public:
  FaultyLens(std::unique_ptr<Lens> lens, const Faults& faults)
      : lens_(std::move(lens)), faults_(faults) {}
  LensInfo info() const override { return lens_->info(); }
  double position() const override { return lens_->position(); }
  Arrival move_to(double position) override { return lens_->move_to(position); }
  Arrival home() override { return lens_->home(); }
  std::string why_unwatched() const override { return faults_.is_unwatched ? faults_.shy : ""; }
  std::unique_ptr<Motion> start(double position) override {
    return std::make_unique<FaultyMotion>(lens_->start(position), faults_);
  }

 private:
  std::unique_ptr<Lens> lens_;
  Faults faults_;
};

/// A camera whose frames come by themselves.
class StreamingCamera final : public Camera {
 public:
  explicit StreamingCamera(std::unique_ptr<Camera> camera) : camera_(std::move(camera)) {}
  std::string description() const override { return camera_->description(); }
  CameraSettings settings() const override { return camera_->settings(); }
  Validity validate(CameraSettings& wished) const override { return camera_->validate(wished); }
  void apply(const CameraSettings& settings) override { camera_->apply(settings); }
  bool is_live() const override { return true; }
  bool streams() const override { return true; }
  void skip_until(std::int64_t time_ns) override { camera_->skip_until(time_ns); }
  std::optional<Frame> grab(std::chrono::milliseconds timeout) override {
    return camera_->grab(timeout);
  }

 private:
  std::unique_ptr<Camera> camera_;
};

RigOptions options_for(const std::string& rig) {
  RigOptions options;
  options.rig = rig;
  return options;
}

Rig faulty(const RigOptions& options, const Faults& faults) {
  Hardware hardware = open_hardware(options.rig);
  hardware.lens = std::make_unique<FaultyLens>(std::move(hardware.lens), faults);
  return Rig(options, std::move(hardware));
}

struct Kept {
  RunFile file;
  std::vector<HaltsInstead> halts;
  std::size_t frames = 0;
  const Run& run() const { return file.runs.back(); }
};

struct Warned final : Observer {
  explicit Warned(Kept& kept) : kept_(kept) {}
  void frame(const Frame&, const Arrival&, std::span<const double>) override { ++kept_.frames; }
  void warned(const Warning& warning) override {
    if (const auto* halts = std::get_if<HaltsInstead>(&warning)) kept_.halts.push_back(*halts);
  }

 private:
  Kept& kept_;
};

FocusRequest moving(std::optional<bool> wish = true) {
  FocusRequest request;
  request.moving = wish;
  return request;
}

Kept focus(Rig& rig, const FocusRequest& request) {
  Kept kept;
  RunKeeper keeper(setup_of(rig));
  Warned warned(kept);
  Observers all({&keeper, &warned});
  Session(rig).focus(request, all);
  kept.file = RunFile::parse(keeper.file.json(), "kept");
  return kept;
}

constexpr const char* kRig = "sim:distance=1600,start=300";

TEST(MovingSearch, SeesPicturesOnTheWayAndComputesAgain) {
  for (const char* place :
       {kRig, "sim:distance=1600,start=1150,seed=3", "sim:distance=2400,start=480,noise=24"}) {
    Rig rig(options_for(place));
    const Kept kept = focus(rig, moving());
    EXPECT_TRUE(kept.run().limits->moves) << place;
    const Journey journey = journey_of(kept.run());
    EXPECT_GE(journey.on_the_way, 10) << place;
    EXPECT_EQ(kept.frames, static_cast<std::size_t>(journey.frames)) << "observers see each";
    EXPECT_TRUE(same_answer(kept.file, rerun(kept.file, "kept"))) << place;
    EXPECT_TRUE(kept.halts.empty()) << place;
  }
}

TEST(MovingSearch, IsQuickerThanWithHaltsAndAsTrue) {
  const double truth = simulated::focused_position_steps(1600);
  for (const int start : {500, 1100}) {
    const auto cost = [&](bool moves) {
      Rig rig(options_for("sim:distance=1600,start=" + std::to_string(start)));
      const Kept kept = focus(rig, moving(moves));
      EXPECT_NEAR(kept.run().focus->position(), truth, 1) << start;
      EXPECT_EQ(kept.run().focus->result(), FocusResult::focused) << start;
      return journey_of(kept.run()).rig_seconds;
    };
    EXPECT_LT(cost(true), cost(false)) << start;
  }
}

// What counts the travel must count what the lens runs on after it was told to stop.
TEST(MovingSearch, ItsTravelIsThatOfTheLens) {
  Rig rig(options_for(kRig));
  const Kept kept = focus(rig, moving());
  int set_out = 0;
  for (const Measurement& m : kept.run().measurements) set_out += m.set_out_from.has_value();
  EXPECT_EQ(set_out, 1) << "one travel, halted once";
  const TimeSpent spent = time_spent(kept.run().measurements);
  const double searching = spent.moving + spent.settling + spent.exposing;
  EXPECT_NEAR(searching, journey_of(kept.run()).rig_seconds, 0.5) << "but for the first frames";
}

TEST(MovingSearch, ItsAnswerRestsOnPicturesAtRest) {
  Rig rig(options_for("sim:distance=1600,start=300,optics=untold"));
  FocusRequest request = moving();
  request.blur = BlurModel{.px_per_unit = 0.08};
  const Kept kept = focus(rig, request);
  EXPECT_GE(journey_of(kept.run()).on_the_way, 10);
  for (const Evaluation& e : kept.run().focus->evaluations)
    EXPECT_EQ(e.position, std::round(e.position)) << "on the way it is anywhere";
  for (const Evaluation& e : kept.run().evaluations_at_rest()) EXPECT_FALSE(e.on_the_way);
  if (const auto learned = blur_of(kept.run())) {
    EXPECT_LE(learned->pictures, static_cast<int>(kept.run().evaluations_at_rest().size()));
  }
}

TEST(MovingSearch, MovesByItselfWhereThatPays) {
  const auto on_the_way = [](bool streams, int average, std::optional<bool> wish) {
    RigOptions options = options_for(kRig);
    options.shot.average = average;
    Hardware hardware = open_hardware(options.rig);
    if (streams) hardware.camera = std::make_unique<StreamingCamera>(std::move(hardware.camera));
    Rig rig(options, std::move(hardware));
    const Kept kept = focus(rig, moving(wish));
    EXPECT_TRUE(kept.halts.empty()) << "nobody asked";
    return journey_of(kept.run()).on_the_way;
  };
  EXPECT_GT(on_the_way(true, 1, std::nullopt), 0);
  EXPECT_EQ(on_the_way(true, 1, false), 0);
  EXPECT_EQ(on_the_way(true, 2, std::nullopt), 0);
  EXPECT_EQ(on_the_way(false, 1, std::nullopt), 0) << "every frame must be asked for";
}

TEST(MovingSearch, SaysWhyItHaltsInstead) {
  const auto reason = [](const std::string& place, const Faults& faults) {
    const RigOptions options = options_for(place);
    Rig rig = faulty(options, faults);
    const Kept kept = focus(rig, moving());
    EXPECT_EQ(kept.run().focus->result(), FocusResult::focused) << place;
    EXPECT_TRUE(same_answer(kept.file, rerun(kept.file, "kept"))) << place;
    EXPECT_LT(journey_of(kept.run()).on_the_way, 10) << place;
    EXPECT_EQ(kept.halts.size(), 1u) << place;
    return kept.halts.empty() ? HaltsInstead{} : kept.halts[0];
  };
  using Why = HaltsInstead::Why;
  EXPECT_EQ(reason(kRig, {.more_smear = 40}).why, Why::too_quick);
  EXPECT_EQ(reason(kRig, {.is_unplaced = true}).why, Why::unplaced);
  const HaltsInstead shy = reason(kRig, {.is_unwatched = true});
  EXPECT_EQ(shy.why, Why::unwatched);
  EXPECT_EQ(shy.lens_says, "it hides");
  EXPECT_EQ(reason(std::string(kRig) + ",optics=untold", {}).why, Why::not_by_spectra);
}

TEST(MovingSearch, EndsWithTheMotorAndKeepsWhatItHas) {
  const RigOptions options = options_for(kRig);
  Rig rig = faulty(options, {.fails_after = 40});
  RunKeeper keeper(setup_of(rig));
  expect_error(ErrorCode::device_lost, [&] { Session(rig).focus(moving(), keeper); }, {"burns"});
  EXPECT_GT(keeper.file.runs.at(0).measurements.size(), 4u);
  EXPECT_FALSE(keeper.file.runs[0].focus);
  EXPECT_NO_THROW(rig.lens().position()) << "it stands";
}

TEST(MovingSearch, EndsOnAWishOnTheWay) {
  int asked = 0;
  RigOptions options = options_for(kRig);
  options.shot.stop_requests = [&] { return ++asked > 60 ? 1 : 0; };
  Rig rig(options);
  RunKeeper keeper(setup_of(rig));
  expect_error(ErrorCode::cancelled, [&] { Session(rig).focus(moving(), keeper); });
  const auto& made = keeper.file.runs.at(0).measurements;
  ASSERT_FALSE(made.empty());
  EXPECT_TRUE(made.back().on_the_way);
  EXPECT_NEAR(rig.lens().position(), made.back().position, 10) << "it did not go on";
}

TEST(MovingSearch, RefusesWishesThatContradictIt) {
  const auto refused = [](const RigOptions& options, FocusRequest request, ErrorCode code,
                          const char* why) {
    Rig rig(options);
    Observer nobody;
    request.moving = true;
    expect_error(code, [&] { Session(rig).focus(request, nobody); }, {why});
  };
  FocusRequest coarse, budget;
  coarse.search = SearchMethod::coarse;
  budget.frames = 3;
  refused(options_for(kRig), coarse, ErrorCode::bad_argument, "coarse");
  refused(options_for(kRig), budget, ErrorCode::bad_argument, "number of frames");
  RigOptions averaged = options_for(kRig);
  averaged.shot.average = 2;
  refused(averaged, {}, ErrorCode::bad_argument, "averaged");
}

}  // namespace
}  // namespace fathom
