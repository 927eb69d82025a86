// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "engine/error.hpp"
#include "hal/camera_settings.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/aravis/camera_clock.hpp"
#include "hal/drivers/aravis/controls.hpp"
#include "hal/drivers/aravis/stream.hpp"

namespace fathom::aravis {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kSecond_ns = 1000 * kMillisecond_ns;
/// Days: more than anybody waits, and far from what a clock cannot count.
constexpr std::int64_t kLongestWait_ms = 1'000'000'000;
/// The clock of a camera is read again after so long, this often in a row.
constexpr std::int64_t kLatchAgain_ns = 10 * kSecond_ns;
constexpr int kLatches = 5;
/// A camera that says it waits for a trigger, and gives nothing so long after the exposure, has lost it.
constexpr std::int64_t kOverdue_ns = 2 * kSecond_ns;
/// No frame is that old when it is read: then its stamp is not of the clock that was latched.
constexpr std::int64_t kOldest_ns = 30 * kSecond_ns;

/// How far the clock of the wall is ahead of the rig's.
std::int64_t wall_ahead_ns() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * kSecond_ns + now.tv_nsec - monotonic_now_ns();
}

/// The names of one command and one value: of today's standard, and of GigE Vision 1.
struct ClockNames {
  const char* latch;
  const char* value;
  const char* ticks_per_s;  ///< Null: the value is in ns.
};
constexpr ClockNames kClockNames[] = {
    {"TimestampLatch", "TimestampLatchValue", nullptr},
    {"GevTimestampControlLatch", "GevTimestampValue", "GevTimestampTickFrequency"}};

class AravisCamera final : public Camera {
 public:
  AravisCamera(const std::shared_ptr<Device>& device, const CameraKeys& keys,
               StopRequests stop_requests)
      : device_(device),
        stop_requests_(std::move(stop_requests)),
        keys_(keys),
        controls_(device, keys),
        wall_ahead_ns_(wall_ahead_ns()) {
    find_clock();
    start();
  }

  std::string description() const override {
    return fmt::format("aravis {} ({}), {} {} x {} px, {}", device_->model(), device_->name(),
                       controls_.format().name, settings().width_px, settings().height_px,
                       controls_.is_triggered() ? "triggered" : "free running");
  }

  CameraSettings settings() const override { return controls_.settings(); }

  Validity validate(CameraSettings& wished) const override {
    if (!have_meaning(wished)) return Validity::refused;
    return adjust(wished, controls_.nearest(wished));
  }

  void apply(const CameraSettings& settings) override {
    require_valid(*this, settings);
    if (settings == this->settings()) return;
    stop();
    try {
      controls_.apply(settings);
    } catch (...) {
      start();
      throw;
    }
    start();
  }

  bool is_live() const override { return true; }
  bool streams() const override { return !controls_.is_triggered(); }
  FrameCounts counts() const override { return counts_; }

  std::optional<Frame> grab(std::chrono::milliseconds timeout) override {
    if (device_->is_lost()) device_->fail_lost();
    if (stream_ == nullptr) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("{}: its stream broke; start again", device_->name()));
    }
    const StopWatch watch(stop_requests_);
    const std::int64_t wait_ms = std::clamp<std::int64_t>(timeout.count(), 0, kLongestWait_ms);
    const std::int64_t deadline_ns = monotonic_now_ns() + wait_ms * kMillisecond_ns;
    latch_if_due();
    const std::int64_t ahead_ns = wall_ahead_ns();
    // The wall's clock may have been set while frames waited: the earlier of two answers counts.
    earliest_ahead_ns_ = std::max(ahead_ns, std::exchange(wall_ahead_ns_, ahead_ns));
    return next_frame(deadline_ns, watch);
  }

 private:
  std::optional<Frame> next_frame(std::int64_t deadline_ns, const StopWatch& watch) {
    // A camera that sends nothing but damage as fast as we read it must not hold us for ever.
    int late = keys_.buffers;
    do {
      if (controls_.is_triggered() && !triggered_ns_) trigger();
      ArvBuffer* const buffer = stream_->take(earlier_of_overdue(deadline_ns), watch);
      if (buffer == nullptr) {
        if (!is_overdue()) return std::nullopt;
        ++counts_.dropped;  // the trigger or its frame got lost
        stop();
        start();
        continue;
      }
      std::optional<Frame> frame = read(buffer);
      stream_->give_back(buffer);
      if (frame) {
        ++counts_.delivered;
        return frame;
      }
    } while (monotonic_now_ns() < deadline_ns || --late > 0);
    return std::nullopt;
  }

  void start() {
    stream_ = nullptr;
    stream_ = std::make_unique<Stream>(device_, StreamOptions{keys_.buffers, keys_.packet_bytes});
    last_number_.reset();
    unread_ = 0;
  }

  void stop() {
    stream_ = nullptr;
    triggered_ns_.reset();
  }

  void trigger() {
    triggered_ns_ = monotonic_now_ns();
    device_->execute("TriggerSoftware");
  }

  std::int64_t exposure_ns() const { return std::llround(settings().exposure_ms * 1e6); }
  std::int64_t overdue_ns() const { return *triggered_ns_ + exposure_ns() + kOverdue_ns; }
  bool is_overdue() const { return triggered_ns_ && monotonic_now_ns() >= overdue_ns(); }
  std::int64_t earlier_of_overdue(std::int64_t deadline_ns) const {
    return triggered_ns_ ? std::min(deadline_ns, overdue_ns()) : deadline_ns;
  }

  /// Nothing for a frame that is damaged, or of a trigger before the last one.
  std::optional<Frame> read(ArvBuffer* buffer) {
    count_missing(buffer);
    const std::int64_t arrived_ns = arrival_ns(buffer);
    const std::optional<std::int64_t> triggered_ns = std::exchange(triggered_ns_, std::nullopt);
    std::optional<Frame> frame = decode(buffer);
    if (!frame) {
      ++counts_.corrupt;
      return std::nullopt;
    }
    frame->exposure = triggered_ns ? Exposure{*triggered_ns, std::max(*triggered_ns, arrived_ns)}
                                   : free_exposure(buffer, arrived_ns);
    frame->exposure.start_ns = std::max(frame->exposure.start_ns, last_.start_ns + 1);
    frame->exposure.end_ns =
        std::max({frame->exposure.end_ns, frame->exposure.start_ns, last_.end_ns + 1});
    last_ = frame->exposure;
    return frame;
  }

  std::optional<Frame> decode(ArvBuffer* buffer) const {
    if (api().arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) return std::nullopt;
    std::size_t size = 0;
    const auto* const bytes =
        static_cast<const std::uint8_t*>(api().arv_buffer_get_image_data(buffer, &size));
    const PixelFormat* const format =
        find_pixel_format(api().arv_buffer_get_image_pixel_format(buffer));
    if (bytes == nullptr || format == nullptr) return std::nullopt;
    gint padding_x = 0, padding_y = 0;
    api().arv_buffer_get_image_padding(buffer, &padding_x, &padding_y);
    const Layout layout{api().arv_buffer_get_image_width(buffer),
                        api().arv_buffer_get_image_height(buffer),
                        static_cast<std::size_t>(std::max(padding_x, 0))};
    auto frame = to_grey(*format, layout, keys_.bayer, {bytes, size});
    const CameraSettings promised = settings();
    const bool is_as_promised = frame && frame->width_px() == promised.width_px &&
                                frame->height_px() == promised.height_px &&
                                frame->depth() == promised.depth;
    return is_as_promised ? std::move(frame) : std::nullopt;
  }

  /// What passed while all buffers were full, because nobody grabbed, is no loss.
  void count_missing(ArvBuffer* buffer) {
    const std::uint64_t number = api().arv_buffer_get_frame_id(buffer);
    const std::uint64_t unread = stream_->unread();
    if (last_number_) {
      const std::uint64_t missing = missing_between(*last_number_, number);
      const std::uint64_t excused = unread - unread_;
      if (missing > excused) counts_.dropped += missing - excused;
    }
    last_number_ = number;
    unread_ = unread;
  }

  /// When its first packet came; not later than now.
  std::int64_t arrival_ns(ArvBuffer* buffer) const {
    const auto wall_ns = static_cast<std::int64_t>(api().arv_buffer_get_system_timestamp(buffer));
    const std::int64_t now_ns = monotonic_now_ns();
    return wall_ns == 0 ? now_ns : std::min(now_ns, wall_ns - earliest_ahead_ns_);
  }

  /// Nobody has seen the shutter: what is known is when it had closed.
  Exposure free_exposure(ArvBuffer* buffer, std::int64_t arrived_ns) const {
    const std::int64_t closed_ns = arrived_ns - exposure_ns();
    if (clock_.is_known()) {
      const std::int64_t stamp_ns =
          clock_.earliest_ns(static_cast<std::int64_t>(api().arv_buffer_get_timestamp(buffer)));
      const std::int64_t start_ns = keys_.stamps_start ? stamp_ns : stamp_ns - exposure_ns();
      const bool is_of_that_clock = std::abs(arrived_ns - stamp_ns) < kOldest_ns + exposure_ns();
      if (is_of_that_clock) return {std::min(start_ns, closed_ns), arrived_ns};
    }
    const std::int64_t interval_ns = std::max(controls_.interval_ns(), exposure_ns());
    const auto waited_ns =
        static_cast<std::int64_t>(keys_.delay_frames * static_cast<double>(interval_ns));
    return {closed_ns - waited_ns, arrived_ns};
  }

  /// Of a camera that is triggered the computer's clock is enough.
  void find_clock() {
    if (controls_.is_triggered()) return;
    for (const ClockNames& names : kClockNames) {
      const bool has_rate = names.ticks_per_s == nullptr || device_->has(names.ticks_per_s);
      if (!has_rate || !device_->has(names.latch) || !device_->has(names.value)) continue;
      clock_names_ = &names;
      latch_if_due();
      return;
    }
  }

  void latch_if_due() {
    if (clock_names_ == nullptr) return;
    if (clock_.is_known() && monotonic_now_ns() < clock_.latched_ns() + kLatchAgain_ns) return;
    std::optional<Latch> narrowest;
    for (int i = 0; i < kLatches; ++i) {
      const Latch latch = latch_once();
      if (!narrowest || latch.width_ns() < narrowest->width_ns()) narrowest = latch;
    }
    clock_.add(*narrowest);
  }

  Latch latch_once() const {
    Latch latch;
    latch.before_ns = monotonic_now_ns();
    device_->execute(clock_names_->latch);
    latch.after_ns = monotonic_now_ns();
    const std::int64_t ticks = device_->integer(clock_names_->value);
    latch.camera_ns = ticks;
    if (clock_names_->ticks_per_s == nullptr) return latch;
    const std::int64_t ticks_per_s =
        std::max<std::int64_t>(device_->integer(clock_names_->ticks_per_s), 1);
    // As Aravis does with a frame's stamp.
    latch.camera_ns =
        ticks / ticks_per_s * kSecond_ns + ticks % ticks_per_s * kSecond_ns / ticks_per_s;
    return latch;
  }

  // In the order in which they are made; what they put back goes the other way round.
  std::shared_ptr<Device> device_;
  StopRequests stop_requests_;
  CameraKeys keys_;
  Controls controls_;
  CameraClock clock_;
  const ClockNames* clock_names_ = nullptr;
  std::int64_t wall_ahead_ns_;
  std::int64_t earliest_ahead_ns_ = 0;
  FrameCounts counts_;
  Exposure last_;
  std::optional<std::uint64_t> last_number_;
  std::uint64_t unread_ = 0;
  std::optional<std::int64_t> triggered_ns_;  ///< Of the frame that is awaited.
  std::unique_ptr<Stream> stream_;
};

}  // namespace

std::unique_ptr<Camera> open_camera(const std::shared_ptr<Device>& device, const CameraKeys& keys,
                                    const StopRequests& stop_requests) {
  return std::make_unique<AravisCamera>(device, keys, stop_requests);
}

}  // namespace fathom::aravis
