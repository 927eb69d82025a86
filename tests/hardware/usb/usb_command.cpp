// SPDX-License-Identifier: Apache-2.0
// Sends a command to running devices: usb_command WORDS..., to the socket $FATHOM_USB_SOCKET.
#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

#include "commands.hpp"

int main(int argc, char** argv) try {
  const char* socket = std::getenv("FATHOM_USB_SOCKET");
  std::string line;
  for (int i = 1; i < argc; ++i) line += std::string(i > 1 ? " " : "") + argv[i];
  const std::string answer =
      fathom::usb::command(socket != nullptr ? socket : "/tmp/fathom-usb", line);
  fmt::print("{}\n", answer);
  return answer.rfind("error", 0) == 0 ? 1 : 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "usb_command: {}\n", error.what());
  return 1;
}
