// SPDX-License-Identifier: Apache-2.0
// A serial port: bytes out, lines in.
#pragma once

#include <termios.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace fathom::serial {

/// The speeds that a port can be set to, baud.
bool is_known_speed(int baud);

/// A terminal device that belongs to this program alone while it is open; raw, 8 bits, no parity,
/// one stop bit, no flow control. Its settings are put back at the end, and the lines that reset
/// many boards are left as they are then. Every call throws Error(device_lost) where the device has
/// gone.
class Port {
 public:
  /// line_end: what ends a line that comes. Throws Error(unavailable): not there, no permission, in
  /// use; Error(bad_argument) for what is no serial port, or a speed that is none.
  Port(std::string path, int baud, std::string line_end);
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  ~Port();

  const std::string& path() const { return path_; }

  /// Throws Error(timeout) if the device does not take them within two seconds.
  void write(const std::string& bytes);

  /// The next line without its end and without what cannot be printed; nothing if none is complete
  /// by then. Of a line that is longer than any device sends, the end is kept.
  std::optional<std::string> read_line(std::int64_t until_ns);

 private:
  void set_up(int baud);
  std::optional<std::string> take_line();
  /// Waits for bytes, or for room; false if there is none by then.
  bool wait(short events, std::int64_t until_ns) const;
  [[noreturn]] void fail(const char* doing, int error) const;

  std::string path_;
  std::string line_end_;
  int fd_ = -1;
  termios before_{};
  std::string received_;
};

}  // namespace fathom::serial
