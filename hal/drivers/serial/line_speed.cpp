// SPDX-License-Identifier: Apache-2.0
// A file of its own: <asm/termbits.h> and <termios.h> both define struct termios.
#include "hal/drivers/serial/line_speed.hpp"

#ifdef __linux__
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <cstdlib>
#endif

namespace fathom::serial {

#ifdef __linux__
bool set_line_speed(int terminal, int baud) {
  const auto speed = static_cast<speed_t>(baud);
  termios2 line{};
  if (::ioctl(terminal, TCGETS2, &line) != 0) return false;
  line.c_cflag &= ~static_cast<tcflag_t>(CBAUD | CBAUD << IBSHIFT);
  line.c_cflag |= BOTHER;  // and no speed of its own for what comes: it is the same
  line.c_ispeed = line.c_ospeed = speed;
  if (::ioctl(terminal, TCSETS2, &line) != 0 || ::ioctl(terminal, TCGETS2, &line) != 0)
    return false;
  // A driver says which speed its divisor gives; beyond 2 % characters are garbled.
  const long beside = std::labs(static_cast<long>(line.c_ospeed) - baud);
  return beside <= baud / 50;
}
#else
bool set_line_speed(int, int) { return false; }
#endif

}  // namespace fathom::serial
