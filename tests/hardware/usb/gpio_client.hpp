// SPDX-License-Identifier: Apache-2.0
// Lines of the simulated GPIO chip through the kernel's own interface, without a library.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <vector>

namespace fathom::usb {

/// Lines of the chip $FATHOM_GPIOCHIP, all with the same flags.
class GpioClient {
 public:
  GpioClient(std::vector<unsigned> lines, std::uint64_t flags) {
    const int chip = ::open(std::getenv("FATHOM_GPIOCHIP"), O_RDWR | O_CLOEXEC);
    gpio_v2_line_request request{};
    for (const unsigned line : lines) request.offsets[request.num_lines++] = line;
    request.config.flags = flags;
    if (::ioctl(chip, GPIO_V2_GET_LINE_IOCTL, &request) == 0) file_ = request.fd;
    ::close(chip);
  }
  GpioClient(const GpioClient&) = delete;
  GpioClient& operator=(const GpioClient&) = delete;
  ~GpioClient() { ::close(file_); }
  bool opened() const { return file_ >= 0; }

  void set(unsigned index, bool high) {
    gpio_v2_line_values values{high ? 1ULL << index : 0, 1ULL << index};
    ASSERT_EQ(::ioctl(file_, GPIO_V2_LINE_SET_VALUES_IOCTL, &values), 0);
  }
  bool get() {  ///< Of the first.
    gpio_v2_line_values values{0, 1};
    EXPECT_EQ(::ioctl(file_, GPIO_V2_LINE_GET_VALUES_IOCTL, &values), 0);
    return values.bits != 0;
  }

 private:
  int file_ = -1;
};

}  // namespace fathom::usb
