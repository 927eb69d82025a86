// SPDX-License-Identifier: Apache-2.0
#include "fake_system.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace fathom::test {
namespace {

void set_text(unsigned char* to, std::size_t size, const std::string& text) {
  std::memset(to, 0, size);
  std::memcpy(to, text.data(), std::min(size, text.size()));
}

std::uint32_t bytes_per_row(std::uint32_t fourcc, std::uint32_t width) {
  const bool is_wide = fourcc == V4L2_PIX_FMT_YUYV || fourcc == V4L2_PIX_FMT_Y16 ||
                       fourcc == V4L2_PIX_FMT_Y10 || fourcc == V4L2_PIX_FMT_Y12;
  return is_wide ? 2 * width : width;
}

}  // namespace

const FakeFormat* FakeNode::find(std::uint32_t fourcc) const {
  for (const FakeFormat& entry : formats) {
    if (entry.fourcc == fourcc) return &entry;
  }
  return nullptr;
}

/// As uvcvideo: an unknown format becomes the first, a size the nearest.
void FakeNode::adjust(v4l2_pix_format& pix) const {
  const FakeFormat* const known = find(pix.pixelformat);
  const FakeFormat& entry = known != nullptr ? *known : formats.front();
  const auto off = [&](const std::pair<int, int>& size) {
    return std::llabs(size.first - static_cast<long long>(pix.width)) +
           std::llabs(size.second - static_cast<long long>(pix.height));
  };
  const auto nearest =
      *std::min_element(entry.sizes.begin(), entry.sizes.end(),
                        [&](const auto& one, const auto& other) { return off(one) < off(other); });
  pix.pixelformat = entry.fourcc;
  pix.width = static_cast<std::uint32_t>(nearest.first);
  pix.height = static_cast<std::uint32_t>(nearest.second);
  pix.bytesperline = bytes_per_row(entry.fourcc, pix.width) + entry.gap_bytes;
  pix.sizeimage = 2 * pix.bytesperline * pix.height;  // room to spare, as for JPEG
}

int FakeNode::control_ioctl(unsigned long request, void* argument) {
  if (request == VIDIOC_QUERYCTRL) {
    auto& query = *static_cast<v4l2_queryctrl*>(argument);
    const auto found = controls.find(query.id);
    if (found == controls.end()) return -EINVAL;
    const FakeControl& control = found->second;
    set_text(query.name, sizeof query.name, control.name);
    query.minimum = control.lowest;
    query.maximum = control.highest;
    query.step = control.step;
    query.flags = control.flags;
    return 0;
  }
  auto& wanted = *static_cast<v4l2_control*>(argument);
  const auto found = controls.find(wanted.id);
  if (found == controls.end()) return -EINVAL;
  FakeControl& control = found->second;
  if (request == VIDIOC_G_CTRL) {
    wanted.value = control.reads ? control.reads(control.value) : control.value;
    return 0;
  }
  if (const int refusal = control.refusal; refusal != 0) {
    if (on_write_refused) on_write_refused();
    return -refusal;
  }
  // As in UVC: no manual exposure while the automatic is on.
  const auto automatic = controls.find(V4L2_CID_EXPOSURE_AUTO);
  if (wanted.id == V4L2_CID_EXPOSURE_ABSOLUTE && automatic != controls.end() &&
      automatic->second.value != V4L2_EXPOSURE_MANUAL) {
    return -EACCES;
  }
  written.emplace_back(wanted.id, wanted.value);
  control.value = control.becomes ? control.becomes(wanted.value) : wanted.value;
  return 0;
}

int FakeNode::format_ioctl(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_ENUM_FMT: {
      auto& description = *static_cast<v4l2_fmtdesc*>(argument);
      if (description.index >= formats.size()) return -EINVAL;
      description.pixelformat = formats[description.index].fourcc;
      return 0;
    }
    case VIDIOC_ENUM_FRAMESIZES: {
      auto& size = *static_cast<v4l2_frmsizeenum*>(argument);
      const FakeFormat* const entry = find(size.pixel_format);
      if (!lists_sizes || entry == nullptr || size.index >= entry->sizes.size()) return -EINVAL;
      size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
      size.discrete.width = static_cast<std::uint32_t>(entry->sizes[size.index].first);
      size.discrete.height = static_cast<std::uint32_t>(entry->sizes[size.index].second);
      return 0;
    }
    case VIDIOC_ENUM_FRAMEINTERVALS: {
      auto& interval = *static_cast<v4l2_frmivalenum*>(argument);
      const FakeFormat* const entry = find(interval.pixel_format);
      if (entry == nullptr || entry->fps == 0 || interval.index > 0) return -EINVAL;
      interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
      interval.discrete = {1000, static_cast<std::uint32_t>(entry->fps * 1000)};
      return 0;
    }
    case VIDIOC_TRY_FMT:
      adjust(static_cast<v4l2_format*>(argument)->fmt.pix);
      return 0;
    case VIDIOC_S_FMT:
      if (!buffers_.empty()) return -EBUSY;
      adjust(static_cast<v4l2_format*>(argument)->fmt.pix);
      format = static_cast<v4l2_format*>(argument)->fmt.pix;
      return 0;
    case VIDIOC_G_FMT:
      static_cast<v4l2_format*>(argument)->fmt.pix = format;
      return 0;
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM: {
      auto& rate = static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
      if (request == VIDIOC_S_PARM && rate.denominator != 0) {
        interval_ns = std::max<std::int64_t>(1'000'000'000LL * rate.numerator / rate.denominator,
                                             10 * kMs);  // 100 fps is its fastest
      }
      rate = {static_cast<std::uint32_t>(interval_ns / 1000), 1'000'000};
      return 0;
    }
    default:
      return -ENOTTY;
  }
}

int FakeNode::buffer_ioctl(unsigned long request, void* argument, std::int64_t now_ns) {
  switch (request) {
    case VIDIOC_REQBUFS: {
      auto& wanted = *static_cast<v4l2_requestbuffers*>(argument);
      if (mapped > 0 && wanted.count == 0) return -EBUSY;  // memory that is still mapped
      buffers_.assign(wanted.count, std::vector<std::uint8_t>(format.sizeimage));
      queued_.clear();
      ready_.clear();
      return 0;
    }
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      buffer.length = static_cast<std::uint32_t>(buffers_.at(buffer.index).size());
      buffer.m.offset = buffer.index;
      return 0;
    }
    case VIDIOC_QBUF:
      queued_.push_back(static_cast<v4l2_buffer*>(argument)->index);
      return 0;
    case VIDIOC_DQBUF:
      if (is_broken) return -EIO;
      if (ready_.empty()) return -EAGAIN;
      *static_cast<v4l2_buffer*>(argument) = ready_.front();
      ready_.pop_front();
      return 0;
    case VIDIOC_STREAMON:
      is_streaming = true;
      ++starts;
      sequence_ = 0;
      next_ns_ = now_ns + interval_ns;
      return 0;
    case VIDIOC_STREAMOFF:
      is_streaming = false;
      return 0;
    default:
      return -ENOTTY;
  }
}

int FakeNode::ioctl(unsigned long request, void* argument, std::int64_t now_ns) {
  requests.push_back(request);
  if (is_unplugged) return -ENODEV;
  run_to(now_ns);
  if (const auto refusal = refusals.find(request); refusal != refusals.end()) {
    return -refusal->second;
  }
  switch (request) {
    case VIDIOC_QUERYCTRL:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return control_ioctl(request, argument);
    case VIDIOC_QUERYCAP: {
      if (is_subdevice) return -ENOTTY;
      auto& answer = *static_cast<v4l2_capability*>(argument);
      set_text(answer.driver, sizeof answer.driver, driver);
      set_text(answer.card, sizeof answer.card, card);
      answer.capabilities = capabilities | V4L2_CAP_DEVICE_CAPS;
      answer.device_caps = capabilities;
      return 0;
    }
    case VIDIOC_G_INPUT:
      *static_cast<int*>(argument) = input;
      return 0;
    case VIDIOC_S_INPUT:
      if (*static_cast<int*>(argument) >= inputs) return -EINVAL;
      input = *static_cast<int*>(argument);
      return 0;
    default: {
      const int answer = format_ioctl(request, argument);
      return answer != -ENOTTY ? answer : buffer_ioctl(request, argument, now_ns);
    }
  }
}

void FakeNode::throw_away(int count) {
  for (; count > 0; --count, ++sequence_) {
    queued_.push_back(queued_.front());
    queued_.pop_front();
  }
}

void FakeNode::fill(std::int64_t stamp_ns) {
  const std::uint32_t number = sequence_++;
  if (queued_.empty()) return;  // nobody reads: lost
  v4l2_buffer buffer{};
  buffer.index = queued_.front();
  queued_.pop_front();
  std::vector<std::uint8_t>& bytes = buffers_[buffer.index];
  std::fill(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(number));
  buffer.flags = buffer_flags;
  buffer.sequence = number;
  buffer.bytesused = format.bytesperline * format.height;
  buffer.timestamp.tv_sec = stamp_ns / 1'000'000'000;
  buffer.timestamp.tv_usec = stamp_ns % 1'000'000'000 / 1000;
  if (on_frame) on_frame(buffer, bytes);
  ready_.push_back(buffer);
}

void FakeNode::run_to(std::int64_t now_ns) {
  if (!is_streaming || is_stalled) {
    next_ns_ = std::max(next_ns_, now_ns);
    return;
  }
  for (; next_ns_ <= now_ns; next_ns_ += interval_ns) fill(next_ns_);
}

FakeNode& FakeSystem::add(const std::string& path) {
  nodes_[path] = std::make_unique<FakeNode>();
  return *nodes_[path];
}

int FakeSystem::open(const std::string& path) {
  if (is_interrupted()) return -EINTR;
  const auto found = nodes_.find(resolve(path));
  if (found == nodes_.end()) return -ENOENT;
  if (found->second->open_error != 0) return -found->second->open_error;
  ++found->second->open_count;
  ++found->second->times_opened;
  descriptors_[next_descriptor_] = found->second.get();
  return next_descriptor_++;
}

void FakeSystem::close(int descriptor) {
  --node(descriptor).open_count;
  descriptors_.erase(descriptor);
}

int FakeSystem::ioctl(int descriptor, unsigned long request, void* argument) {
  if (is_interrupted()) return -EINTR;
  return node(descriptor).ioctl(request, argument, now_ns_);
}

int FakeSystem::poll(int descriptor, std::chrono::milliseconds timeout) {
  if (is_interrupted()) return -EINTR;
  if (on_sleep && timeout.count() > 0) on_sleep();
  FakeNode& polled = node(descriptor);
  const std::int64_t until_ns = now_ns_ + timeout.count() * kMs;
  for (;;) {
    if (polled.is_unplugged) return POLLERR | POLLHUP;
    polled.run_to(now_ns_);
    if (polled.has_ready()) return POLLIN;
    if (polled.is_broken) return POLLERR;
    const bool comes = polled.is_streaming && !polled.is_stalled;
    if (now_ns_ >= until_ns) return 0;
    now_ns_ = comes ? std::min(until_ns, polled.next_frame_ns()) : until_ns;
  }
}

void* FakeSystem::map(int descriptor, std::size_t, std::int64_t offset) {
  ++node(descriptor).mapped;
  void* const memory = node(descriptor).buffer_at(offset);
  mappings_[memory] = &node(descriptor);
  return memory;
}

void FakeSystem::unmap(void* memory, std::size_t) { --mappings_.at(memory)->mapped; }

void FakeSystem::sleep_until_ns(std::int64_t time_ns) {
  if (on_sleep) on_sleep();
  now_ns_ = std::max(now_ns_, time_ns);
}

std::vector<std::string> FakeSystem::list(const std::string& folder) {
  std::vector<std::string> paths;
  const auto add_if_inside = [&](const std::string& path) {
    if (path.substr(0, path.rfind('/')) == folder) paths.push_back(path);
  };
  for (const auto& entry : nodes_) add_if_inside(entry.first);
  for (const auto& entry : links) add_if_inside(entry.first);
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::string FakeSystem::resolve(const std::string& path) {
  const auto found = links.find(path);
  return found == links.end() ? path : found->second;
}

FakeNode& add_webcam(FakeSystem& system, const std::string& path) {
  FakeNode& node = system.add(path);
  node.formats = {{V4L2_PIX_FMT_YUYV, {{64, 48}, {32, 24}}},
                  {V4L2_PIX_FMT_GREY, {{32, 24}}, 5},
                  {V4L2_PIX_FMT_Y16, {{32, 24}, {16, 12}}}};
  node.controls = {
      {V4L2_CID_EXPOSURE_AUTO_PRIORITY, {"Exposure, Dynamic Framerate", 0, 1, 1, 1}},
      {V4L2_CID_EXPOSURE_AUTO, {"Auto Exposure", 0, 3, 1, V4L2_EXPOSURE_APERTURE_PRIORITY}},
      {V4L2_CID_EXPOSURE_ABSOLUTE, {"Exposure Time, Absolute", 3, 2047, 1, 250}},
      {V4L2_CID_AUTOGAIN, {"Gain, Automatic", 0, 1, 1, 1}},
      {V4L2_CID_GAIN, {"Gain", 0, 255, 5, 60}},
      {V4L2_CID_AUTO_WHITE_BALANCE, {"White Balance, Automatic", 0, 1, 1, 1}},
      {V4L2_CID_FOCUS_AUTO, {"Focus, Automatic Continuous", 0, 1, 1, 1}},
      {V4L2_CID_FOCUS_ABSOLUTE, {"Focus, Absolute", 0, 252, 5, 100}},
  };
  v4l2_format format{};
  format.fmt.pix.width = 32;
  format.fmt.pix.height = 24;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_YUYV;
  node.ioctl(VIDIOC_S_FMT, &format, 0);
  node.requests.clear();
  return node;
}

}  // namespace fathom::test
