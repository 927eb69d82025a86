// SPDX-License-Identifier: Apache-2.0
// The simulated motor, driven through the stock driver's GPIO chip with the kernel's own
// interface. Run by usb_devices (FATHOM_GPIOCHIP) with --motor-start 30 --motor-rate 100
// --motor-backlash 5 --log /tmp/edges.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "commands.hpp"
#include "gpio_client.hpp"
#include "stepper.hpp"

namespace fathom::usb {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds period{30};  // Far from the motor's 10: sleeping takes longer at times.

std::string socket_path() { return std::getenv("FATHOM_USB_SOCKET"); }

// One number of the status.
int status(const std::string& name) {
  const std::string text = ' ' + command(socket_path(), "status");
  const std::size_t at = text.find(' ' + name + '=');
  return at == std::string::npos ? -1 : std::stoi(text.substr(at + name.size() + 2));
}

struct UsbStepper : testing::Test {
  UsbStepper()
      : lines({Stepper::step, Stepper::direction}, GPIO_V2_LINE_FLAG_OUTPUT),
        home({Stepper::home}, GPIO_V2_LINE_FLAG_INPUT) {}
  void SetUp() override { ASSERT_TRUE(lines.opened() && home.opened()); }
  void go(bool forward, int steps, milliseconds period_ms) {
    lines.set(1, forward);
    for (int i = 0; i < steps; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      lines.set(0, true);
      std::this_thread::sleep_for(period_ms / 2);
      lines.set(0, false);
      std::this_thread::sleep_until(begin + period_ms);
    }
  }
  GpioClient lines, home;
};

TEST_F(UsbStepper, CountsStepsBothWays) {
  const int before = status("motor");
  go(true, 12, period);
  EXPECT_EQ(status("motor"), before + 12);
  go(false, 12, period);
  EXPECT_EQ(status("motor"), before);
  EXPECT_EQ(status("lost"), 0);
}

TEST_F(UsbStepper, HasPlay) {
  go(true, 8, period);  // The play is taken up.
  const int before = status("carriage");
  go(false, 5, period);
  EXPECT_EQ(status("carriage"), before);
  go(false, 3, period);
  EXPECT_EQ(status("carriage"), before - 3);
}

TEST_F(UsbStepper, LosesStepsAboveItsRate) {
  const int lost = status("lost");
  go(true, 20, milliseconds(4));
  EXPECT_GT(status("lost"), lost + 10);
}

TEST_F(UsbStepper, LosesStepsOnCommand) {
  const int before = status("motor");
  ASSERT_EQ(command(socket_path(), "bridge lose 4"), "ok");
  go(true, 10, period);
  EXPECT_EQ(status("motor"), before + 6);
}

TEST_F(UsbStepper, PressesItsHomeSwitchAndStopsAtItsEnd) {
  EXPECT_TRUE(home.get());
  go(false, status("motor"), period);
  EXPECT_FALSE(home.get());
  EXPECT_EQ(status("motor"), 0);
  go(false, 25, period);
  EXPECT_EQ(status("motor"), -20);
}

TEST_F(UsbStepper, WritesEveryEdgeWithItsTime) {
  lines.set(0, false);
  std::ifstream log("/tmp/edges");
  std::int64_t time_ns = 0, last_ns = 0;
  std::string line;
  int high = 0, motor = 0, carriage = 0, edges = 0;
  for (; log >> time_ns >> line >> high >> motor >> carriage; ++edges) {
    EXPECT_GE(time_ns, last_ns);
    last_ns = time_ns;
  }
  EXPECT_GT(edges, 150);
  EXPECT_EQ(motor, status("motor"));
}

}  // namespace
}  // namespace fathom::usb
