// SPDX-License-Identifier: Apache-2.0
// A system with made-up V4L2 nodes and a clock that runs only while somebody waits.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/drivers/v4l2/system.hpp"

namespace fathom::test {

inline constexpr std::int64_t kMs = 1'000'000;

/// A control as a driver keeps it.
struct FakeControl {
  std::string name;
  std::int32_t lowest = 0, highest = 0, step = 1, value = 0;
  std::uint32_t flags = 0;
  int refusal = 0;  ///< errno of every write.
  /// What a write makes of a value, in silence.
  std::function<std::int32_t(std::int32_t)> becomes = {};
  std::function<std::int32_t(std::int32_t)> reads = {};  ///< What a read tells of the value.
};

struct FakeFormat {
  std::uint32_t fourcc;
  std::vector<std::pair<int, int>> sizes;
  std::uint32_t gap_bytes = 0;  ///< Between rows.
  double fps = 0;               ///< Its only rate; 0: it does not tell.
};

/// One node. A frame comes every `interval_ns` of the fake clock while it streams.
class FakeNode {
 public:
  std::string card = "Fake camera", driver = "fake";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  bool is_subdevice = false;
  std::vector<FakeFormat> formats;
  std::map<std::uint32_t, FakeControl> controls;
  std::int64_t interval_ns = 40 * kMs;
  std::uint32_t buffer_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  bool lists_sizes = true;
  int inputs = 1, input = 0;

  int open_error = 0;
  std::map<unsigned long, int> refusals;  ///< errno of an ioctl, by its request.
  bool is_unplugged = false, is_stalled = false, is_broken = false;
  std::function<void()> on_write_refused;  ///< Called when a control refuses a write.
  /// Changes a frame before it is handed over: `bytesused`, flags, pixels, the stamp.
  std::function<void(v4l2_buffer&, std::vector<std::uint8_t>&)> on_frame;

  v4l2_pix_format format{};                                     ///< In force.
  std::vector<std::pair<std::uint32_t, std::int32_t>> written;  ///< Controls set, in order.
  std::vector<unsigned long> requests;                          ///< Every ioctl, in order.
  int open_count = 0, times_opened = 0, mapped = 0;
  bool is_streaming = false;
  int starts = 0;

  int ioctl(unsigned long request, void* argument, std::int64_t now_ns);
  /// Makes the frames that are due.
  void run_to(std::int64_t now_ns);
  std::int64_t next_frame_ns() const { return next_ns_; }
  bool has_ready() const { return !ready_.empty(); }
  void* buffer_at(std::int64_t offset) { return buffers_[static_cast<std::size_t>(offset)].data(); }
  /// Frames that a driver without a free buffer threw away.
  std::uint32_t sequence() const { return sequence_; }
  void skip_sequence(std::uint32_t count) { sequence_ += count; }
  /// The next frames are filled and not handed over.
  void throw_away(int count);

 private:
  const FakeFormat* find(std::uint32_t fourcc) const;
  void adjust(v4l2_pix_format& pix) const;
  int control_ioctl(unsigned long request, void* argument);
  int format_ioctl(unsigned long request, void* argument);
  int buffer_ioctl(unsigned long request, void* argument, std::int64_t now_ns);
  void fill(std::int64_t stamp_ns);

  std::vector<std::vector<std::uint8_t>> buffers_;
  std::deque<std::uint32_t> queued_;
  std::deque<v4l2_buffer> ready_;
  std::int64_t next_ns_ = 0;
  std::uint32_t sequence_ = 0;
};

class FakeSystem final : public v4l2::System {
 public:
  /// Adds a node under a path.
  FakeNode& add(const std::string& path);
  FakeNode& at(const std::string& path) { return *nodes_.at(path); }
  std::map<std::string, std::string> links;  ///< Path to what it stands for.
  std::function<void()> on_sleep;            ///< Called whenever somebody waits.

  int open(const std::string& path) override;
  void close(int descriptor) override;
  int ioctl(int descriptor, unsigned long request, void* argument) override;
  int poll(int descriptor, std::chrono::milliseconds timeout) override;
  void* map(int descriptor, std::size_t length, std::int64_t offset) override;
  void unmap(void* memory, std::size_t length) override;
  std::int64_t now_ns() override { return now_ns_; }
  void sleep_until_ns(std::int64_t time_ns) override;
  std::vector<std::string> list(const std::string& folder) override;
  std::string resolve(const std::string& path) override;

  int interruptions = 0;  ///< So many calls of the system are ended by a signal first.

 private:
  FakeNode& node(int descriptor) { return *descriptors_.at(descriptor); }
  bool is_interrupted() { return interruptions > 0 && interruptions-- > 0; }

  std::map<std::string, std::unique_ptr<FakeNode>> nodes_;
  std::map<int, FakeNode*> descriptors_;
  std::map<void*, FakeNode*> mappings_;
  int next_descriptor_ = 3;
  std::int64_t now_ns_ = 1'000'000 * kMs;
};

/// A webcam: GREY, YUYV and Y16, exposure, gain, white balance and focus, all automatic.
FakeNode& add_webcam(FakeSystem& system, const std::string& path = "/dev/video0");

}  // namespace fathom::test
