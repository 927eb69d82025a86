// SPDX-License-Identifier: Apache-2.0
#include "python/own_rig.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/clock.hpp"
#include "python/arrays.hpp"
#include "python/errors.hpp"

namespace fathom::python {
namespace {

constexpr const char* kPicture = "the array of snap()";

/// What camera and lens share. Every call into Python takes its lock.
struct Shared {
  OwnRig rig;
  int stale = 0;  // pictures to throw away before the next one counts

  /// A picture that holds its array.
  Frame take() const {
    const py::gil_scoped_acquire lock;
    const std::int64_t start_ns = monotonic_now_ns();
    const Pictures picture(rig.snap(), kPicture);
    if (picture.is_stack()) refuse("snap() gave a stack; give one picture (rows, columns)");
    Frame frame = frame_holding(picture, 0);
    frame.exposure = {start_ns, monotonic_now_ns()};
    return frame;
  }

  double position() const {
    const py::gil_scoped_acquire lock;
    return rig.position.is_none() ? rig.start : rig.position().cast<double>();
  }
};

void let_go(Shared* shared) {
  const py::gil_scoped_acquire lock;
  delete shared;
}

class OwnCamera final : public Camera {
 public:
  explicit OwnCamera(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {
    const Frame first = shared_->take();
    settings_ = {first.width_px(), first.height_px(), first.depth(), shared_->rig.exposure_ms};
  }

  std::string description() const override {
    return fmt::format("camera of {} x {} px", settings_.width_px, settings_.height_px);
  }
  CameraSettings settings() const override { return settings_; }
  Validity validate(CameraSettings& wished) const override { return adjust(wished, settings_); }
  void apply(const CameraSettings& wished) override {
    if (wished != settings_)
      throw Error(ErrorCode::unsupported, "set up the camera before it is given to fathom");
  }
  bool is_live() const override { return true; }

  std::optional<Frame> grab(std::chrono::milliseconds) override {
    for (; shared_->stale > 0; --shared_->stale) shared_->take();
    ++counts_.delivered;
    return shared_->take();
  }
  FrameCounts counts() const override { return counts_; }

 private:
  std::shared_ptr<Shared> shared_;
  CameraSettings settings_;
  FrameCounts counts_;
};

class OwnLens final : public Lens {
 public:
  explicit OwnLens(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}

  LensInfo info() const override { return shared_->rig.travel; }
  double position() const override { return shared_->position(); }

  Arrival move_to(double position) override {
    require_within(info(), position);
    const double goal = nearest(position);
    const std::int64_t started_ns = monotonic_now_ns();
    {
      const py::gil_scoped_acquire lock;
      shared_->rig.move_to(goal);
      shared_->rig.start = goal;
    }
    shared_->stale = shared_->rig.stale;
    const std::int64_t rest_ns = monotonic_now_ns();
    return {.position = this->position(),
            .started_ns = started_ns,
            .stopped_ns = rest_ns,
            .settled_ns = rest_ns};
  }

  Arrival home() override { return move_to(info().lowest); }
  std::string why_unwatched() const override {
    return "move_to() says nothing before the stage has arrived";
  }

 private:
  std::shared_ptr<Shared> shared_;
};

}  // namespace

Hardware own_hardware(OwnRig rig) {
  const std::shared_ptr<Shared> shared(new Shared{std::move(rig)}, let_go);
  return {.camera = std::make_unique<OwnCamera>(shared),
          .lens = std::make_unique<OwnLens>(shared),
          .stage = nullptr};
}

}  // namespace fathom::python
