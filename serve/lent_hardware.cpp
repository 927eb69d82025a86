// SPDX-License-Identifier: Apache-2.0
#include "serve/lent_hardware.hpp"

#include <utility>

namespace fathom::serve {
namespace {

class LentCamera final : public Camera {
 public:
  LentCamera(Camera& camera, const HardwareWatch& watch) : camera_(camera), watch_(watch) {}

  std::string description() const override { return camera_.description(); }
  CameraSettings settings() const override { return camera_.settings(); }
  Validity validate(CameraSettings& wished) const override { return camera_.validate(wished); }
  void apply(const CameraSettings& settings) override { camera_.apply(settings); }
  bool is_live() const override { return camera_.is_live(); }
  bool streams() const override { return camera_.streams(); }
  int recorded_here() const override { return camera_.recorded_here(); }
  std::chrono::milliseconds patience() const override { return camera_.patience(); }
  void skip_until(std::int64_t time_ns) override { camera_.skip_until(time_ns); }
  FrameCounts counts() const override { return camera_.counts(); }

  std::optional<Frame> grab(std::chrono::milliseconds timeout) override {
    std::optional<Frame> frame = camera_.grab(timeout);
    if (frame) watch_.frame(*frame);
    return frame;
  }

 private:
  Camera& camera_;
  const HardwareWatch& watch_;
};

/// Tells that a lens has arrived, however the move ends.
class Move {
 public:
  explicit Move(const HardwareWatch& watch) : watch_(watch) { watch_.departed(); }
  Move(const Move&) = delete;
  Move& operator=(const Move&) = delete;
  ~Move() { watch_.arrived(arrival); }

  std::optional<Arrival> arrival;

 private:
  const HardwareWatch& watch_;
};

class LentMotion final : public Motion {
 public:
  LentMotion(std::unique_ptr<Motion> motion, const HardwareWatch& watch)
      : move_(watch), motion_(std::move(motion)) {}

  void stop() override { motion_->stop(); }
  std::optional<Arrival> arrived() override { return move_.arrival = motion_->arrived(); }
  Arrival wait() override { return *(move_.arrival = motion_->wait()); }

 private:
  Where do_during(const Exposure& exposure) const override { return motion_->during(exposure); }

  Move move_;  // ends after the motion does
  std::unique_ptr<Motion> motion_;
};

class LentLens final : public Lens {
 public:
  LentLens(Lens& lens, const HardwareWatch& watch) : lens_(lens), watch_(watch) {}

  LensInfo info() const override { return lens_.info(); }
  double position() const override { return lens_.position(); }
  std::string why_unwatched() const override { return lens_.why_unwatched(); }
  void declare_at(double position) override { lens_.declare_at(position); }

  Arrival move_to(double position) override {
    Move move(watch_);
    return *(move.arrival = lens_.move_to(position));
  }
  Arrival home() override {
    Move move(watch_);
    return *(move.arrival = lens_.home());
  }
  std::unique_ptr<Motion> start(double position) override {
    return std::make_unique<LentMotion>(lens_.start(position), watch_);
  }

 private:
  Lens& lens_;
  const HardwareWatch& watch_;
};

class LentStage final : public TargetStage {
 public:
  explicit LentStage(TargetStage& stage) : stage_(stage) {}
  double distance_mm() const override { return stage_.distance_mm(); }
  double distance_mm(double x_px, double y_px) const override {
    return stage_.distance_mm(x_px, y_px);
  }
  void place_at(double distance_mm) override { stage_.place_at(distance_mm); }

 private:
  TargetStage& stage_;
};

}  // namespace

Hardware LentHardware::lend() {
  Hardware lent;
  lent.camera = std::make_unique<LentCamera>(*hardware_.camera, watch_);
  lent.lens = std::make_unique<LentLens>(*hardware_.lens, watch_);
  if (hardware_.stage) lent.stage = std::make_unique<LentStage>(*hardware_.stage);
  lent.findings = std::exchange(hardware_.findings, {});
  return lent;
}

}  // namespace fathom::serve
