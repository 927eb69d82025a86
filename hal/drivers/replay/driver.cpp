// SPDX-License-Identifier: Apache-2.0
// A rig of recorded pictures: the lens chooses one, the camera gives it.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/drivers/replay/stack.hpp"
#include "hal/rig_driver.hpp"
#include "hal/rig_text.hpp"

namespace fathom {

const RigDriver& replay_driver();

namespace {

/// How long a move and an exposure last on the replay's clock. It only orders events: a frame taken
/// after a move must be stamped later than the move.
constexpr std::int64_t kTick_ns = 1'000'000;

/// What camera and lens share.
struct Recording {
  std::string path;
  replay::RecordedStack stack;
  std::size_t current = 0;  // the position at which the lens stands
  std::size_t turn = 0;     // which of its pictures comes next
  std::int64_t now_ns = 0;

  std::string description() const {
    return fmt::format("replay of {}, {} frames of {}", path, stack.size(),
                       to_string(stack.shape()));
  }

  std::shared_ptr<const Frame> next_frame() {
    return stack.frame(current, turn++ % stack.pictures_at(current));
  }
};

class ReplayCamera final : public Camera {
 public:
  explicit ReplayCamera(std::shared_ptr<Recording> recording) : recording_(std::move(recording)) {}

  std::string description() const override { return recording_->description(); }

  CameraSettings settings() const override {
    const PictureShape shape = recording_->stack.shape();
    return {shape.width_px, shape.height_px, shape.depth, 0};
  }

  /// A recording is what it is: every wish that makes sense is adjusted to it.
  Validity validate(CameraSettings& wished) const override {
    return have_meaning(wished) ? adjust(wished, settings()) : Validity::refused;
  }

  void apply(const CameraSettings& wished) override {
    if (wished == settings()) return;
    throw Error(ErrorCode::unsupported,
                fmt::format("{} cannot change its size, depth or exposure", description()));
  }

  bool is_live() const override { return false; }

  int recorded_here() const override {
    return static_cast<int>(recording_->stack.pictures_at(recording_->current));
  }

  std::optional<Frame> grab(std::chrono::milliseconds) override {
    const auto stored = recording_->next_frame();
    Frame frame = Frame::view(stored->row(0), stored->width_px(), stored->height_px(),
                              stored->depth(), stored->stride_bytes(), stored);
    frame.exposure.start_ns = recording_->now_ns;
    frame.exposure.end_ns = recording_->now_ns += kTick_ns;
    frame.lens_position = recording_->stack.positions()[recording_->current];
    return frame;
  }

 private:
  std::shared_ptr<Recording> recording_;
};

class ReplayLens final : public Lens {
 public:
  explicit ReplayLens(std::shared_ptr<Recording> recording) : recording_(std::move(recording)) {}

  LensInfo info() const override {
    const replay::RecordedStack& stack = recording_->stack;
    return {.description = recording_->description(),
            .unit = stack.unit(),
            .lowest = stack.positions().front(),
            .highest = stack.positions().back(),
            .resolution = stack.resolution(),
            .coarse_spacing = stack.coarse_spacing(),
            .stops = stack.positions(),
            .stop_names = stack.names()};
  }

  double position() const override { return recording_->stack.positions()[recording_->current]; }

  Arrival move_to(double position) override {
    require_within(info(), position);
    recording_->current = recording_->stack.index_of(nearest(position));
    recording_->turn = 0;
    const std::int64_t started_ns = recording_->now_ns;
    const std::int64_t rest_ns = recording_->now_ns += kTick_ns;
    Arrival arrival{.position = this->position(),
                    .started_ns = started_ns,
                    .stopped_ns = rest_ns,
                    .settled_ns = rest_ns};
    if (arrival.position != position) {
      arrival.note = fmt::format("position {} was not recorded; the nearest, {}, is used", position,
                                 arrival.position);
    }
    return arrival;
  }

  Arrival home() override { return move_to(info().lowest); }

  std::string why_unwatched() const override {
    return "a recording has no pictures of the way from one position to the next";
  }

 private:
  std::shared_ptr<Recording> recording_;
};

class ReplayDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "replay"; }

  const char* summary() const noexcept override {
    return "recorded pictures: replay:FOLDER (positions from its manifest.csv, else 0, 1, 2, ... "
           "by name) or replay:STACK.tif; keys: channel (number, name, or r, g, b), time, image, "
           "scale";
  }

  const char* bare_key() const noexcept override { return "path"; }

  std::span<const std::string_view> trailing_keys() const noexcept override {
    static constexpr std::string_view kKeys[] = {"channel", "time", "image", "scale"};
    return kKeys;
  }

  std::span<const std::string_view> path_keys() const noexcept override {
    static constexpr std::string_view kKeys[] = {"path"};
    return kKeys;
  }

  Hardware open(const RigSettings& settings, const OpenOptions&) const override {
    const std::string path = path_in(settings);
    const auto recording =
        std::make_shared<Recording>(Recording{path, replay::RecordedStack(path, wishes(settings))});
    return {.camera = std::make_unique<ReplayCamera>(recording),
            .lens = std::make_unique<ReplayLens>(recording),
            .stage = nullptr,
            .findings = recording->stack.findings()};
  }

  static replay::RecordedStack stack_of(const RigSettings& settings) {
    const std::string path = path_in(settings);
    const replay::Wishes chosen = wishes(settings);
    settings.require_all_used();
    return replay::RecordedStack(path, chosen);
  }

 private:
  static std::string path_in(const RigSettings& settings) {
    const std::string path = settings.text("path", "");
    if (!path.empty()) return path;
    throw Error(ErrorCode::bad_argument,
                fmt::format("{}: which pictures? Write replay:FOLDER or replay:STACK.tif",
                            settings.where()));
  }

  static replay::Wishes wishes(const RigSettings& settings) {
    constexpr long long kMost = 1'000'000'000;
    constexpr double kLargestScale = 1e30;
    const auto index = [&](const char* key) {
      return settings.has(key) ? std::optional<std::size_t>(settings.integer(key, 0, 0, kMost))
                               : std::nullopt;
    };
    return {.channel = settings.text("channel", ""),
            .time = index("time"),
            .image = index("image"),
            .scale = settings.number("scale", 0, 0, kLargestScale)};
  }
};

}  // namespace

namespace replay {

std::optional<RecordedStack> open_recording(std::string_view rig) {
  const RigRequest request = parse_rig(rig);
  const bool is_one = !request.lens && request.camera.driver == &replay_driver();
  if (!is_one) return std::nullopt;
  return ReplayDriver::stack_of(request.camera.settings);
}

}  // namespace replay

const RigDriver& replay_driver() {
  static const ReplayDriver driver;
  return driver;
}

}  // namespace fathom
