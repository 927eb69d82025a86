// SPDX-License-Identifier: Apache-2.0
#include "bench/honesty/recording.hpp"

#include <algorithm>
#include <memory>

namespace fathom::honesty {
namespace {

struct Recording {
  std::vector<Frame> pictures;
  std::vector<double> positions;
  std::size_t current = 0;
  std::int64_t now_ns = 0;
};

class Camera final : public fathom::Camera {
 public:
  explicit Camera(std::shared_ptr<Recording> recording) : recording_(std::move(recording)) {}

  std::string description() const override { return "recording"; }
  CameraSettings settings() const override {
    const Frame& first = recording_->pictures.front();
    return {first.width_px(), first.height_px(), first.depth(), 0};
  }
  Validity validate(CameraSettings& wished) const override {
    if (wished == settings()) return Validity::valid;
    wished = settings();
    return Validity::adjusted;
  }
  void apply(const CameraSettings&) override {}
  bool is_live() const override { return false; }
  std::optional<Frame> grab(std::chrono::milliseconds) override {
    Frame frame = recording_->pictures[recording_->current].clone();
    frame.exposure = {recording_->now_ns, recording_->now_ns + 1};
    ++recording_->now_ns;
    return frame;
  }

 private:
  std::shared_ptr<Recording> recording_;
};

class Lens final : public fathom::Lens {
 public:
  explicit Lens(std::shared_ptr<Recording> recording) : recording_(std::move(recording)) {}

  LensInfo info() const override {
    const std::vector<double>& stops = recording_->positions;
    double spacing = stops.back() - stops.front();
    double widest = 0;
    for (std::size_t i = 1; i < stops.size(); ++i) {
      spacing = std::min(spacing, stops[i] - stops[i - 1]);
      widest = std::max(widest, stops[i] - stops[i - 1]);
    }
    LensInfo info;
    info.unit = "steps";
    info.lowest = stops.front();
    info.highest = stops.back();
    info.resolution = spacing;
    info.coarse_spacing = widest;  // so few pictures that each is looked at
    info.stops = stops;
    return info;
  }
  double position() const override { return recording_->positions[recording_->current]; }
  Arrival move_to(double position) override {
    const std::vector<double>& stops = recording_->positions;
    const auto at = std::lower_bound(stops.begin(), stops.end(), nearest(position));
    recording_->current = static_cast<std::size_t>(at - stops.begin());
    const std::int64_t now = ++recording_->now_ns;
    return {.position = *at, .started_ns = now, .stopped_ns = now, .settled_ns = now};
  }
  Arrival home() override { return move_to(info().lowest); }

 private:
  std::shared_ptr<Recording> recording_;
};

}  // namespace

Hardware play(std::vector<Frame> pictures, std::vector<double> positions) {
  const auto recording = std::make_shared<Recording>();
  recording->pictures = std::move(pictures);
  recording->positions = std::move(positions);
  return {std::make_unique<Camera>(recording), std::make_unique<Lens>(recording), nullptr};
}

}  // namespace fathom::honesty
