// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/stand.hpp"

#include <fmt/format.h>

#include <cstring>

#include "engine/error.hpp"

namespace fathom::v4l2 {

Stand::Stand(std::shared_ptr<Device> device, std::optional<int> input)
    : device_(std::move(device)) {
  if (input) select(*input);
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device_->attempt(VIDIOC_G_FMT, format) == 0) format_ = format;
  v4l2_streamparm rate{};
  rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device_->attempt(VIDIOC_G_PARM, rate) == 0) rate_ = rate;
}

void Stand::select(int input) {
  int found = 0;
  device_->call(VIDIOC_G_INPUT, found, "it has no inputs to choose from; leave input out");
  if (found == input) return;
  const int error = device_->attempt(VIDIOC_S_INPUT, input);
  if (error == EINVAL) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} has no input {}; `v4l2-ctl --list-inputs` shows them",
                            device_->path(), input));
  }
  if (error != 0) device_->fail(error, fmt::format("cannot select input {}", input));
  input_ = found;
}

Stand::~Stand() {
  std::vector<std::function<int()>> steps;
  if (format_) steps.emplace_back([this] { return put_back_format(); });
  if (rate_) steps.emplace_back([this] { return put_back_rate(); });
  if (input_) steps.emplace_back([this] { return device_->attempt(VIDIOC_S_INPUT, *input_); });
  device_->put_back(std::move(steps));
}

// A camera that somebody else uses refuses every format and rate, also those that it has.
int Stand::put_back_format() {
  v4l2_format now{};
  now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  const bool is_known = device_->attempt(VIDIOC_G_FMT, now) == 0;
  if (is_known && std::memcmp(&now.fmt.pix, &format_->fmt.pix, sizeof now.fmt.pix) == 0) return 0;
  v4l2_format format = *format_;
  return device_->attempt(VIDIOC_S_FMT, format);
}

int Stand::put_back_rate() {
  v4l2_streamparm now{};
  now.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  const v4l2_fract& found = rate_->parm.capture.timeperframe;
  const v4l2_fract& its = now.parm.capture.timeperframe;
  const bool is_known = device_->attempt(VIDIOC_G_PARM, now) == 0;
  if (is_known && its.numerator == found.numerator && its.denominator == found.denominator) {
    return 0;
  }
  v4l2_streamparm rate = *rate_;
  return device_->attempt(VIDIOC_S_PARM, rate);
}

std::pair<int, int> Stand::size() const {
  constexpr std::pair kUsual{640, 480};
  if (!format_) return kUsual;
  const v4l2_pix_format& pix = format_->fmt.pix;
  constexpr std::uint32_t kLargestSide = 32767;
  if (pix.width == 0 || pix.height == 0 || pix.width > kLargestSide || pix.height > kLargestSide) {
    return kUsual;
  }
  return {static_cast<int>(pix.width), static_cast<int>(pix.height)};
}

}  // namespace fathom::v4l2
