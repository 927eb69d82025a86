// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/stream.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>

#include "engine/error.hpp"
#include "hal/drivers/v4l2/modes.hpp"

namespace fathom::v4l2 {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kMillisecond_ns = 1'000'000;
/// A wait is cut in slices, so that a stop is heard, and a device whose driver wakes nobody when it
/// is unplugged is still missed.
constexpr std::int64_t kSlice_ns = 100 * kMillisecond_ns;

/// Pictures of a hundred megapixels get fewer buffers, not the machine's whole memory.
constexpr std::size_t kMostMemory = std::size_t{256} << 20;
constexpr std::size_t kFewestBuffers = 2;

v4l2_buffer mapped_buffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.index = index;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  return buffer;
}

milliseconds rounded_up(std::int64_t ns) {
  return milliseconds((std::max<std::int64_t>(ns, 0) + kMillisecond_ns - 1) / kMillisecond_ns);
}

}  // namespace

Stream::Stream(std::shared_ptr<Device> device, const StreamOptions& options)
    : device_(std::move(device)),
      is_uvc_(options.is_uvc),
      clock_(frame_interval_ns(*device_), options.delay_frames, device_->system().now_ns()) {
  try {
    map_buffers(options.buffers);
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    device_->call(VIDIOC_STREAMON, type, "cannot start its stream");
  } catch (...) {
    close();
    throw;
  }
}

Stream::~Stream() { close(); }

void Stream::map_buffers(int count) {
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_->call(VIDIOC_G_FMT, format, "cannot get buffers");
  const std::size_t picture_bytes = std::max<std::size_t>(format.fmt.pix.sizeimage, 1);
  const std::size_t most = std::max(kMostMemory / picture_bytes, kFewestBuffers);
  v4l2_requestbuffers request{};
  request.count = static_cast<std::uint32_t>(std::min<std::size_t>(count, most));
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  device_->call(VIDIOC_REQBUFS, request, "cannot get buffers");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = mapped_buffer(i);
    device_->call(VIDIOC_QUERYBUF, buffer, "cannot get buffers");
    void* const memory =
        device_->system().map(device_->descriptor(), buffer.length, buffer.m.offset);
    if (memory == nullptr) {
      throw Error(ErrorCode::out_of_memory,
                  fmt::format("{}: cannot map a buffer of {} bytes; ask for fewer buffers",
                              device_->path(), buffer.length));
    }
    mappings_.push_back({memory, buffer.length, 0});
    queue(buffer);
  }
  if (mappings_.empty()) device_->fail(ENOMEM, "cannot get buffers");
}

void Stream::close() noexcept {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  device_->attempt(VIDIOC_STREAMOFF, type);
  for (const Mapping& mapping : mappings_) device_->system().unmap(mapping.memory, mapping.length);
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  device_->attempt(VIDIOC_REQBUFS, none);
}

void Stream::queue(v4l2_buffer& buffer) {
  mappings_[buffer.index].queued_ns = device_->system().now_ns();
  device_->call(VIDIOC_QBUF, buffer, "its stream broke");
}

void Stream::release(Filled& filled) {
  v4l2_buffer buffer = mapped_buffer(filled.buffer.index);
  filled.bytes = {};
  queue(buffer);
}

bool Stream::is_ready(milliseconds timeout) {
  System& system = device_->system();
  int events = system.poll(device_->descriptor(), timeout);
  // A signal says nothing of the queue; "not ready" must be true, for stamps hang on it.
  while (events == -EINTR) events = system.poll(device_->descriptor(), milliseconds(0));
  if (events < 0) device_->fail(-events, "cannot wait for a frame");
  // Pictures that arrived before an unplugging are in order, so they go first.
  if ((events & POLLIN) != 0) return true;
  if ((events & (POLLHUP | POLLNVAL)) != 0) device_->fail(ENODEV, "its stream ended");
  if ((events & POLLERR) == 0) return false;
  v4l2_capability capability{};  // which tells a device that is gone from a stream that broke
  if (device_->attempt(VIDIOC_QUERYCAP, capability) != 0) device_->fail(ENODEV, "its stream ended");
  throw Error(ErrorCode::device_lost,
              fmt::format("{}: its stream broke; start again", device_->path()));
}

bool Stream::wait(std::int64_t deadline_ns, const StopWatch& watch) {
  System& system = device_->system();
  // Asked before waiting: only what was not ready a moment ago has surely just come.
  std::int64_t asked_ns = system.now_ns();
  if (is_ready(milliseconds(0))) return true;
  for (;;) {
    clock_.nothing_ready(asked_ns);
    asked_ns = system.now_ns();
    if (asked_ns >= deadline_ns) return false;
    if (watch.stopped()) throw Error(ErrorCode::cancelled, "stopped on request");
    if (is_ready(rounded_up(std::min(deadline_ns - asked_ns, kSlice_ns)))) return true;
  }
}

StampKind Stream::kind_of(const v4l2_buffer& buffer) const {
  if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    return StampKind::none;
  }
  if (is_uvc_) return StampKind::first_byte;
  const bool is_start =
      (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  return is_start ? StampKind::exposure : StampKind::last_byte;
}

/// Drivers may fill their buffers in any order, and more than once if they throw a frame away; but
/// one that was given to them before a frame was done, and is still not back, was there for it.
std::int64_t Stream::ready_since_ns() const {
  return std::min_element(mappings_.begin(), mappings_.end(),
                          [](const Mapping& one, const Mapping& other) {
                            return one.queued_ns < other.queued_ns;
                          })
      ->queued_ns;
}

std::optional<Stream::Filled> Stream::take(std::int64_t deadline_ns, const StopWatch& watch) {
  while (wait(deadline_ns, watch)) {
    Filled filled;
    filled.buffer = mapped_buffer(0);
    const int error = device_->attempt(VIDIOC_DQBUF, filled.buffer);
    if (error == EAGAIN) {  // a driver that said that there was one
      if (device_->system().now_ns() >= deadline_ns) return std::nullopt;
      continue;
    }
    if (error == EIO) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("{}: its stream broke; start again", device_->path()));
    }
    if (error != 0) device_->fail(error, "cannot take a frame");
    const v4l2_buffer& buffer = filled.buffer;
    if (buffer.index >= mappings_.size()) device_->fail(EIO, "it filled a buffer that is not ours");
    const Mapping& mapping = mappings_[buffer.index];
    filled.delivery = {
        buffer.sequence, kind_of(buffer),
        buffer.timestamp.tv_sec * 1'000'000'000LL + buffer.timestamp.tv_usec * 1000LL,
        ready_since_ns(), device_->system().now_ns()};
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) == 0) {
      filled.bytes = {static_cast<const std::uint8_t*>(mapping.memory),
                      std::min<std::size_t>(buffer.bytesused, mapping.length)};
    }
    return filled;
  }
  return std::nullopt;
}

}  // namespace fathom::v4l2
