// SPDX-License-Identifier: Apache-2.0
// A file of its own, as line_speed.cpp is.
#include "hal/drivers/serial/line_speed.hpp"

#include <asm/termbits.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "simulated_stage.hpp"

namespace fathom::test {
namespace {

TEST(LineSpeed, OneThatHasNoNameIsSetBothWays) {
  const auto stage = make_stage("marlin", 100);
  const int terminal = ::open(stage->port().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  termios2 before{}, line{};
  ASSERT_EQ(::ioctl(terminal, TCGETS2, &before), 0);
  EXPECT_TRUE(serial::set_line_speed(terminal, 250'000));
  ASSERT_EQ(::ioctl(terminal, TCGETS2, &line), 0);
  EXPECT_EQ(line.c_ospeed, 250'000u);
  EXPECT_EQ(line.c_ispeed, 250'000u);
  EXPECT_EQ(line.c_cflag & ~(CBAUD | CBAUD << IBSHIFT),
            before.c_cflag & ~(CBAUD | CBAUD << IBSHIFT));
  EXPECT_EQ(line.c_lflag, before.c_lflag);
  ::close(terminal);
}

TEST(LineSpeed, WhatIsNoTerminalHasNone) {
  const int nothing = ::open("/dev/null", O_RDWR);
  ASSERT_GE(nothing, 0);
  EXPECT_FALSE(serial::set_line_speed(nothing, 250'000));
  ::close(nothing);
}

}  // namespace
}  // namespace fathom::test
