// SPDX-License-Identifier: Apache-2.0
#include "video_client.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <numeric>
#include <system_error>

namespace fathom::usb {

namespace {

v4l2_buffer empty_buffer() {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  return buffer;
}

}  // namespace

VideoClient::VideoClient(const std::string& device, std::uint32_t fourcc, int width_px,
                         int height_px)
    : file_(::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
  if (file_ < 0) throw std::system_error(errno, std::system_category(), device);
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<unsigned>(width_px);
  format.fmt.pix.height = static_cast<unsigned>(height_px);
  format.fmt.pix.pixelformat = fourcc;
  request(VIDIOC_S_FMT, &format, "format");
  v4l2_requestbuffers wish{};
  wish.count = 4;
  wish.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wish.memory = V4L2_MEMORY_MMAP;
  request(VIDIOC_REQBUFS, &wish, "buffers");
  for (unsigned i = 0; i < wish.count; ++i) {
    v4l2_buffer buffer = empty_buffer();
    buffer.index = i;
    request(VIDIOC_QUERYBUF, &buffer, "buffer");
    void* at =
        ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, file_, buffer.m.offset);
    if (at == MAP_FAILED) throw std::system_error(errno, std::system_category(), "mmap");
    buffers_.emplace_back(static_cast<std::uint8_t*>(at), buffer.length);
    request(VIDIOC_QBUF, &buffer, "queue");
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request(VIDIOC_STREAMON, &type, "start");
}

VideoClient::~VideoClient() {
  for (const std::span<std::uint8_t> buffer : buffers_) ::munmap(buffer.data(), buffer.size());
  ::close(file_);
}

std::optional<VideoFrame> VideoClient::next(int timeout_ms) {
  pollfd poll{file_, POLLIN, 0};
  if (::poll(&poll, 1, timeout_ms) <= 0) return std::nullopt;
  v4l2_buffer buffer = empty_buffer();
  request(VIDIOC_DQBUF, &buffer, "frame");
  VideoFrame frame;
  const auto used = buffers_[buffer.index].first(buffer.bytesused);
  frame.bytes.assign(used.begin(), used.end());
  frame.error = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  frame.sequence = buffer.sequence;
  frame.time_s = static_cast<double>(buffer.timestamp.tv_sec) +
                 1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
  request(VIDIOC_QBUF, &buffer, "queue");
  return frame;
}

VideoFrame VideoClient::fresh() {
  std::optional<VideoFrame> frame;
  for (int i = 0; i < 8; ++i) {  // Twice the buffers.
    frame = next();
    if (!frame) throw std::system_error(ETIMEDOUT, std::system_category(), "no frame");
  }
  return *frame;
}

void VideoClient::set(std::uint32_t control, int value) {
  v4l2_control wish{control, value};
  request(VIDIOC_S_CTRL, &wish, "control");
}

int VideoClient::get(std::uint32_t control) {
  v4l2_control answer{control, 0};
  request(VIDIOC_G_CTRL, &answer, "control");
  return answer.value;
}

int VideoClient::request(unsigned long code, void* argument, const char* what) {
  int result;
  do {
    result = ::ioctl(file_, code, argument);
  } while (result < 0 && errno == EINTR);
  if (result < 0) throw std::system_error(errno, std::system_category(), what);
  return result;
}

double sharpness(std::span<const std::uint8_t> grey, int width_px) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 1; i < grey.size(); ++i) {
    if (i % static_cast<std::size_t>(width_px) == 0) continue;
    const int step = grey[i] - grey[i - 1];
    sum += step * step;
    ++count;
  }
  return sum / static_cast<double>(count);
}

double mean(std::span<const std::uint8_t> grey) {
  return std::accumulate(grey.begin(), grey.end(), 0.0) / static_cast<double>(grey.size());
}

}  // namespace fathom::usb
