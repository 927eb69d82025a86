// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/stream.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/error.hpp"
#include "hal/clock.hpp"

namespace fathom::aravis {
namespace {

constexpr std::int64_t kMicrosecond_ns = 1000;
constexpr std::int64_t kSlice_ns = 50'000'000;
/// A packet that was lost is asked for again this long, and is worth no more.
constexpr guint kFrameRetention_us = 200'000;

}  // namespace

Stream::Stream(std::shared_ptr<Device> device, const StreamOptions& options)
    : device_(std::move(device)) {
  try {
    start(options);
  } catch (...) {  // a constructor that throws has no destructor
    if (stream_ != nullptr) api().g_object_unref(stream_);
    throw;
  }
}

void Stream::start(const StreamOptions& options) {
  ArvCamera* const camera = device_->camera();
  const bool is_gige = api().arv_camera_is_gv_device(camera) != 0;
  if (is_gige && options.packet_bytes > 0) {
    api().arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    device_->ask("set its packet size", [&](GError** error) {
      api().arv_camera_gv_set_packet_size(camera, options.packet_bytes, error);
    });
  }
  stream_ = device_->ask("open its stream", [&](GError** error) {
    return api().arv_camera_create_stream(camera, nullptr, nullptr, error);
  });
  if (stream_ == nullptr) {
    throw Error(ErrorCode::unavailable,
                fmt::format("{}: its stream does not open", device_->name()));
  }
  if (is_gige) {
    api().g_object_set(stream_, "packet-resend", ARV_GV_STREAM_PACKET_RESEND_ALWAYS,
                       "frame-retention", kFrameRetention_us, nullptr);
  }
  const auto payload = device_->ask("ask for the size of its pictures", [&](GError** error) {
    return api().arv_camera_get_payload(camera, error);
  });
  for (int i = 0; i < options.buffers; ++i)
    api().arv_stream_push_buffer(stream_, api().arv_buffer_new_allocate(payload));
  device_->ask("start", [&](GError** error) { api().arv_camera_start_acquisition(camera, error); });
}

Stream::~Stream() {
  try {
    device_->ask("stop", [&](GError** error) {
      api().arv_camera_stop_acquisition(device_->camera(), error);
    });
  } catch (...) {  // lost, or it does not want to: nothing more can be done
  }
  device_->let_go(stream_);
}

ArvBuffer* Stream::take(std::int64_t deadline_ns, const StopWatch& watch) {
  while (true) {
    if (ArvBuffer* const buffer = api().arv_stream_try_pop_buffer(stream_)) return buffer;
    if (device_->is_lost()) device_->fail_lost();
    if (watch.stopped()) throw Error(ErrorCode::cancelled, "stopped on request");
    const std::int64_t left_ns = deadline_ns - monotonic_now_ns();
    if (left_ns <= 0) return nullptr;
    const auto slice_us = static_cast<guint64>(std::min(left_ns, kSlice_ns) / kMicrosecond_ns + 1);
    if (ArvBuffer* const buffer = api().arv_stream_timeout_pop_buffer(stream_, slice_us))
      return buffer;
  }
}

void Stream::give_back(ArvBuffer* buffer) { api().arv_stream_push_buffer(stream_, buffer); }

std::uint64_t Stream::unread() const {
  guint64 completed = 0, failures = 0, underruns = 0;
  api().arv_stream_get_statistics(stream_, &completed, &failures, &underruns);
  return underruns;
}

}  // namespace fathom::aravis
