// SPDX-License-Identifier: Apache-2.0
#include "bench/spectral/set_aside.hpp"

#include <utility>

namespace fathom {
namespace {

/// Until the end of a block.
class Took {
 public:
  explicit Took(const Aside& aside) : aside_(*aside), start_(processor_ms()) {}
  Took(const Took&) = delete;
  Took& operator=(const Took&) = delete;
  ~Took() { aside_ += processor_ms() - start_; }

 private:
  double& aside_;
  double start_;
};

class AsideCamera final : public Camera {
 public:
  AsideCamera(std::unique_ptr<Camera> camera, Aside aside)
      : camera_(std::move(camera)), aside_(std::move(aside)) {}

  std::string description() const override { return camera_->description(); }
  CameraSettings settings() const override { return camera_->settings(); }
  Validity validate(CameraSettings& wished) const override { return camera_->validate(wished); }
  void apply(const CameraSettings& settings) override { camera_->apply(settings); }
  bool is_live() const override { return camera_->is_live(); }
  bool streams() const override { return camera_->streams(); }
  int recorded_here() const override { return camera_->recorded_here(); }
  std::chrono::milliseconds patience() const override { return camera_->patience(); }
  void skip_until(std::int64_t time_ns) override { camera_->skip_until(time_ns); }
  FrameCounts counts() const override { return camera_->counts(); }
  std::optional<Frame> grab(std::chrono::milliseconds timeout) override {
    const Took took(aside_);
    return camera_->grab(timeout);
  }

 private:
  std::unique_ptr<Camera> camera_;
  Aside aside_;
};

class AsideLens final : public Lens {
 public:
  AsideLens(std::unique_ptr<Lens> lens, Aside aside)
      : lens_(std::move(lens)), aside_(std::move(aside)) {}

  LensInfo info() const override { return lens_->info(); }
  double position() const override { return lens_->position(); }
  std::string why_unwatched() const override { return lens_->why_unwatched(); }
  void declare_at(double position) override { lens_->declare_at(position); }
  Arrival move_to(double position) override {
    const Took took(aside_);
    return lens_->move_to(position);
  }
  Arrival home() override { return lens_->home(); }
  std::unique_ptr<Motion> start(double position) override { return lens_->start(position); }

 private:
  std::unique_ptr<Lens> lens_;
  Aside aside_;
};

}  // namespace

Hardware set_aside(Hardware hardware, Aside aside) {
  return {.camera = std::make_unique<AsideCamera>(std::move(hardware.camera), aside),
          .lens = std::make_unique<AsideLens>(std::move(hardware.lens), aside),
          .stage = nullptr,
          .findings = std::move(hardware.findings)};
}

}  // namespace fathom
