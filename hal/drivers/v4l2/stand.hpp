// SPDX-License-Identifier: Apache-2.0
// How a camera stood before it was opened: input, format and frame rate, put back afterwards.
#pragma once

#include <linux/videodev2.h>

#include <memory>
#include <optional>
#include <utility>

#include "hal/drivers/v4l2/device.hpp"

namespace fathom::v4l2 {

class Stand {
 public:
  /// Selects an input if one is given. Throws as Device::fail, Error(unsupported) for an input that
  /// is not there.
  Stand(std::shared_ptr<Device> device, std::optional<int> input);
  Stand(const Stand&) = delete;
  Stand& operator=(const Stand&) = delete;
  ~Stand();

  /// Width and height, px, of the format that was found; 640 x 480 where there was none.
  std::pair<int, int> size() const;

 private:
  void select(int input);
  int put_back_format();
  int put_back_rate();

  std::shared_ptr<Device> device_;
  std::optional<int> input_;
  std::optional<v4l2_format> format_;
  std::optional<v4l2_streamparm> rate_;
};

}  // namespace fathom::v4l2
