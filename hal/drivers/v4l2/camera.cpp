// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/camera.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/drivers/v4l2/controls.hpp"
#include "hal/drivers/v4l2/modes.hpp"
#include "hal/drivers/v4l2/stand.hpp"
#include "hal/drivers/v4l2/stream.hpp"

namespace fathom::v4l2 {
namespace {

/// V4L2_CID_EXPOSURE_ABSOLUTE counts in 100 us.
constexpr double kTicksPerMs = 10;
/// uvcvideo stamps what may have been in the camera's own memory for some frames' time.
constexpr double kUvcDelay_frames = 2;
/// Days: more than anybody waits, and far from what a clock cannot count.
constexpr std::int64_t kLongestWait_ms = 1'000'000'000;

double exposure_ms_of(std::int32_t ticks) { return ticks / kTicksPerMs; }

class V4l2Camera final : public Camera {
 public:
  V4l2Camera(const std::shared_ptr<Device>& device, const v4l2_capability& capability,
             const CameraKeys& keys, const StopRequests& stop_requests)
      : device_(device),
        stand_(device, keys.input),
        controls_(device),
        stop_requests_(stop_requests),
        model_(fixed_text(capability.card, sizeof capability.card)),
        only_format_(format_named(keys.format)),
        fps_(keys.fps) {
    stream_options_.buffers = keys.buffers;
    stream_options_.is_uvc = fixed_text(capability.driver, sizeof capability.driver) == "uvcvideo";
    stream_options_.delay_frames =
        keys.delay_frames.value_or(stream_options_.is_uvc ? kUvcDelay_frames : 0);
    set_mode_of(keys);  // first: a camera in use by somebody else refuses here, untouched
    if (!keys.leave_automatics) {
      focus_ = device->hold_focus(device);
      switch_off_automatics(controls_);
    }
    set_exposure_and_gain(keys);
    stream_ = std::make_unique<Stream>(device_, stream_options_);
  }

  std::string description() const override {
    return fmt::format("v4l2 {} ({}), {} {} x {} px", model_, device_->path(), mode_.format->name,
                       mode_.layout.width_px, mode_.layout.height_px);
  }

  CameraSettings settings() const override {
    return {mode_.layout.width_px, mode_.layout.height_px, mode_.format->depth,
            exposure_ms_of(exposure_ticks_)};
  }

  Validity validate(CameraSettings& wished) const override {
    if (!have_meaning(wished)) return Validity::refused;
    const Mode mode = mode_for(wished);
    const CameraSettings possible{
        mode.layout.width_px, mode.layout.height_px, mode.format->depth,
        exposure_ ? exposure_ms_of(exposure_->nearest(wished.exposure_ms * kTicksPerMs)) : 0};
    return adjust(wished, possible);
  }

  void apply(const CameraSettings& settings) override {
    require_valid(*this, settings);
    if (loss_) throw *loss_;
    if (settings == this->settings()) return;
    restart_with(mode_for(settings), settings.exposure_ms);
  }

  bool is_live() const override { return true; }
  bool streams() const override { return true; }

  FrameCounts counts() const override {
    FrameCounts counts = counts_;
    if (stream_ != nullptr) counts.dropped += stream_->clock().lost();
    return counts;
  }

  std::optional<Frame> grab(std::chrono::milliseconds timeout) override {
    require_stream();
    try {
      return next_frame(timeout);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::device_lost) loss_ = error;
      throw;
    }
  }

 private:
  std::optional<Frame> next_frame(std::chrono::milliseconds timeout) {
    const StopWatch watch(stop_requests_);
    const std::int64_t wait_ms = std::clamp<std::int64_t>(timeout.count(), 0, kLongestWait_ms);
    const std::int64_t deadline_ns = device_->system().now_ns() + wait_ms * 1'000'000;
    // A camera that sends nothing but damage as fast as we read it must not hold us for ever.
    int late = stream_options_.buffers;
    while (auto filled = stream_->take(deadline_ns, watch)) {
      std::optional<Frame> frame = read(*filled);
      stream_->release(*filled);
      if (frame) {
        ++counts_.delivered;
        return frame;
      }
      ++counts_.corrupt;
      if (device_->system().now_ns() >= deadline_ns && --late <= 0) break;
    }
    return std::nullopt;
  }

  static const PixelFormat* format_named(const std::string& name) {
    for (const PixelFormat& format : pixel_formats()) {
      if (format.name == name) return &format;
    }
    return nullptr;  // auto
  }

  Mode mode_for(const CameraSettings& wished) const {
    return nearest_mode(*device_,
                        {wished.width_px, wished.height_px, wished.depth, only_format_, fps_});
  }

  /// As the device stands where nothing is asked for; one side alone takes the other along.
  std::pair<int, int> wished_size(const CameraKeys& keys) const {
    const auto [width_px, height_px] = stand_.size();
    const auto in_proportion = [](int asked, int its, int other) {
      return static_cast<int>(std::max(std::lround(1.0 * asked * other / its), 1L));
    };
    if (keys.width_px == 0 && keys.height_px == 0) return {width_px, height_px};
    if (keys.width_px == 0) {
      return {in_proportion(keys.height_px, height_px, width_px), keys.height_px};
    }
    if (keys.height_px == 0) {
      return {keys.width_px, in_proportion(keys.width_px, width_px, height_px)};
    }
    return {keys.width_px, keys.height_px};
  }

  void set_mode_of(const CameraKeys& keys) {
    const auto [width_px, height_px] = wished_size(keys);
    const ModeWish wish{width_px, height_px, std::nullopt, only_format_, fps_};
    const Mode nearest = nearest_mode(*device_, wish);
    if ((keys.width_px > 0 && nearest.layout.width_px != keys.width_px) ||
        (keys.height_px > 0 && nearest.layout.height_px != keys.height_px)) {
      throw Error(
          ErrorCode::unsupported,
          fmt::format("{} cannot give {} x {} px; the nearest is width={},height={} in {}",
                      device_->path(), wish.width_px, wish.height_px, nearest.layout.width_px,
                      nearest.layout.height_px, nearest.format->name));
    }
    put_in_force(nearest);
  }

  void put_in_force(const Mode& mode) {
    mode_ = set_mode(*device_, mode);
    if (fps_ > 0) set_frame_rate(*device_, fps_);
  }

  void set_exposure_and_gain(const CameraKeys& keys) {
    exposure_ = find_control(*device_, V4L2_CID_EXPOSURE_ABSOLUTE);
    if (exposure_ && exposure_->is_inactive) exposure_.reset();
    if (keys.exposure_ms > 0) {
      if (!exposure_) fail_without("exposure time", "exposure_ms");
      set_exactly(*exposure_, keys.exposure_ms * kTicksPerMs, kTicksPerMs, "exposure_ms");
    }
    if (exposure_) exposure_ticks_ = read_control(*device_, *exposure_);
    if (!keys.gain) return;
    auto gain = find_control(*device_, V4L2_CID_GAIN);
    if (!gain) gain = find_control(*device_, V4L2_CID_ANALOGUE_GAIN);
    if (!gain) fail_without("gain", "gain");
    set_exactly(*gain, *keys.gain, 1, "gain");
  }

  [[noreturn]] void fail_without(const char* what, const char* key) const {
    throw Error(ErrorCode::unsupported, fmt::format("{} has no {} that can be set; leave {} out",
                                                    device_->path(), what, key));
  }

  /// `per_unit`: the control's ticks in one unit of the key.
  void set_exactly(const Control& control, double ticks, double per_unit, const char* key) {
    std::int32_t nearest = control.nearest(ticks);
    // 33.3 ms are 333 ticks though 33.3 * 10 is not quite.
    if (std::abs(nearest - ticks) < 1e-6 * std::max(1.0, ticks)) {
      const std::int32_t got = controls_.set(control, nearest);
      if (got == nearest) return;
      nearest = got;
    }
    throw Error(ErrorCode::unsupported,
                fmt::format("{} cannot keep {}={}; the nearest is {} (of {} to {})",
                            device_->path(), key, ticks / per_unit, nearest / per_unit,
                            control.lowest / per_unit, control.highest / per_unit));
  }

  /// Frames of before are gone with the old stream. What fails leaves things as they were, if it
  /// can.
  void restart_with(const Mode& mode, double exposure_ms) {
    const Mode old_mode = mode_;
    stop_stream();
    try {
      put_in_force(mode);
      if (exposure_) {
        set_exactly(*exposure_, exposure_ms * kTicksPerMs, kTicksPerMs, "exposure_ms");
        exposure_ticks_ = read_control(*device_, *exposure_);
      }
      stream_ = std::make_unique<Stream>(device_, stream_options_);
    } catch (...) {
      start_again(old_mode);
      throw;
    }
  }

  void stop_stream() {
    if (stream_ != nullptr) counts_.dropped += stream_->clock().lost();
    stream_ = nullptr;
  }

  void start_again(const Mode& mode) noexcept {
    try {
      put_in_force(mode);
      if (exposure_) controls_.set(*exposure_, exposure_ticks_);
      stream_ = std::make_unique<Stream>(device_, stream_options_);
    } catch (
        ...) {  // the error that brought us here says more; grab() says that there is no stream
    }
  }

  void require_stream() const {
    if (loss_) throw *loss_;
    if (stream_ != nullptr) return;
    throw Error(ErrorCode::device_lost,
                fmt::format("{}: its stream broke; start again", device_->path()));
  }

  std::optional<Frame> read(const Stream::Filled& filled) {
    const auto exposure_ns = static_cast<std::int64_t>(settings().exposure_ms * 1e6);
    const Exposure exposure = stream_->clock().read(filled.delivery, exposure_ns);
    std::optional<Frame> frame = to_grey(*mode_.format, mode_.layout, filled.bytes);
    if (frame) frame->exposure = exposure;
    return frame;
  }

  // In the order in which they are made; what they put back goes the other way round.
  std::shared_ptr<Device> device_;
  Stand stand_;
  ControlGuard controls_;
  std::shared_ptr<ControlGuard> focus_;
  StopRequests stop_requests_;
  std::string model_;
  const PixelFormat* only_format_;
  double fps_;
  StreamOptions stream_options_;
  Mode mode_;
  std::optional<Control> exposure_;
  std::int32_t exposure_ticks_ = 0;
  FrameCounts counts_;
  std::optional<Error> loss_;  ///< What is lost stays lost, though its driver may start again.
  std::unique_ptr<Stream> stream_;
};

}  // namespace

CameraKeys CameraKeys::read(const RigSettings& settings) {
  constexpr int kLargestSide = 32767;
  constexpr int kMostGain = 1'000'000;
  std::vector<std::string_view> formats = {"auto"};
  for (const PixelFormat& format : pixel_formats()) formats.push_back(format.name);
  static constexpr std::string_view kAutomatics[] = {"off", "leave"};
  CameraKeys keys;
  keys.format = settings.choice("format", "auto", formats);
  keys.width_px = static_cast<int>(settings.integer("width", 0, 1, kLargestSide));
  keys.height_px = static_cast<int>(settings.integer("height", 0, 1, kLargestSide));
  keys.fps = settings.number("fps", 0, 0.01, 4000);
  keys.exposure_ms = settings.number("exposure_ms", 0, 0.1, 1e6);
  const auto gain = static_cast<int>(settings.integer("gain", 0, -kMostGain, kMostGain));
  if (settings.has("gain")) keys.gain = gain;
  const auto input = static_cast<int>(settings.integer("input", 0, 0, 255));
  if (settings.has("input")) keys.input = input;
  keys.buffers = static_cast<int>(settings.integer("buffers", keys.buffers, 2, 32));
  const double delay_frames = settings.number("delay_frames", 0, 0, 100);
  if (settings.has("delay_frames")) keys.delay_frames = delay_frames;
  keys.leave_automatics = settings.choice("automatics", "off", kAutomatics) == "leave";
  return keys;
}

std::unique_ptr<Camera> open_camera(const std::shared_ptr<Device>& device, const CameraKeys& keys,
                                    const StopRequests& stop_requests) {
  v4l2_capability capability{};
  const int error = device->attempt(VIDIOC_QUERYCAP, capability);
  if (error == ENOTTY || error == EINVAL) return nullptr;
  if (error != 0) device->fail(error, "cannot ask what it is");
  if (gives_planes_only(capability)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: multi-planar capture is not supported; `fathom rigs list` shows "
                            "the nodes that can be used",
                            device->path()));
  }
  if (!gives_pictures(capability)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} gives no pictures (a camera's second node gives data about them); "
                            "`fathom rigs list` shows the nodes that do",
                            device->path()));
  }
  return std::make_unique<V4l2Camera>(device, capability, keys, stop_requests);
}

}  // namespace fathom::v4l2
