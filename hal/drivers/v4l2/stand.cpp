// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/stand.hpp"

#include <fmt/format.h>

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
  if (format_) device_->attempt(VIDIOC_S_FMT, *format_);
  if (rate_) device_->attempt(VIDIOC_S_PARM, *rate_);
  if (input_) device_->attempt(VIDIOC_S_INPUT, *input_);
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
