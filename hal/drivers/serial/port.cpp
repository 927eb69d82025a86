// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/serial/port.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/error.hpp"
#include "hal/clock.hpp"
#include "hal/drivers/serial/line_speed.hpp"

namespace fathom::serial {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kWrite_ns = 2'000 * kMillisecond_ns;
constexpr std::size_t kLongestLine = 512;

constexpr std::pair<int, speed_t> kSpeeds[] = {
    {1200, B1200},     {2400, B2400},     {4800, B4800},      {9600, B9600},     {19200, B19200},
    {38400, B38400},   {57600, B57600},   {115200, B115200},  {230400, B230400}, {460800, B460800},
    {500000, B500000}, {921600, B921600}, {1000000, B1000000}};
/// Without a name in termios; boards with a 16 MHz clock keep it exactly, and Marlin comes with it.
constexpr int kUnnamedSpeeds[] = {250000};

std::string reason_of(int error) { return std::generic_category().message(error); }

/// Nothing for one without a name.
std::optional<speed_t> named_speed(int baud) {
  std::vector<int> known(std::begin(kUnnamedSpeeds), std::end(kUnnamedSpeeds));
  if (std::find(known.begin(), known.end(), baud) != known.end()) return std::nullopt;
  for (const auto& [number, speed] : kSpeeds) {
    if (number == baud) return speed;
    known.push_back(number);
  }
  std::sort(known.begin(), known.end());
  throw Error(ErrorCode::bad_argument, fmt::format("baud={} is no speed of a serial port here; "
                                                   "there are {}",
                                                   baud, fmt::join(known, ", ")));
}

std::string advice_for(int error) {
  if (error == EACCES) return "; is this user in the group dialout?";
  if (error == EBUSY) return "; end the program that holds it";
  if (error == ENOENT) return "; fathom rigs list shows what is plugged in";
  return "";
}

}  // namespace

bool is_known_speed(int baud) {
  return std::any_of(std::begin(kSpeeds), std::end(kSpeeds),
                     [&](const auto& speed) { return speed.first == baud; }) ||
         std::find(std::begin(kUnnamedSpeeds), std::end(kUnnamedSpeeds), baud) !=
             std::end(kUnnamedSpeeds);
}

Port::Port(std::string path, int baud, std::string line_end)
    : path_(std::move(path)), line_end_(std::move(line_end)) {
  // Not blocking: opening must not wait for a modem's carrier.
  fd_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) {
    throw Error(ErrorCode::unavailable,
                fmt::format("cannot open {}: {}{}", path_, reason_of(errno), advice_for(errno)));
  }
  try {
    set_up(baud);
  } catch (...) {  // a constructor that throws has no destructor
    ::close(fd_);
    throw;
  }
}

void Port::set_up(int baud) {
  const std::optional<speed_t> speed = named_speed(baud);
  if (::tcgetattr(fd_, &before_) != 0) {
    throw Error(ErrorCode::bad_argument, fmt::format("{} is no serial port", path_));
  }
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    throw Error(ErrorCode::unavailable,
                fmt::format("{} is in use by another program; end it first", path_));
  }
  termios raw = before_;
  ::cfmakeraw(&raw);
  raw.c_cflag |= CLOCAL | CREAD;
  raw.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
  raw.c_cc[VMIN] = 0;
  raw.c_cc[VTIME] = 0;
  if (speed) {
    ::cfsetispeed(&raw, *speed);
    ::cfsetospeed(&raw, *speed);
  }
  if (::tcsetattr(fd_, TCSANOW, &raw) != 0) fail("setting up", errno);
  if (!speed && !set_line_speed(fd_, baud)) {
    ::tcsetattr(fd_, TCSANOW, &before_);
    throw Error(ErrorCode::unsupported, fmt::format("{} cannot be set to {} baud", path_, baud));
  }
  ::ioctl(fd_, TIOCEXCL);
  ::tcflush(fd_, TCIOFLUSH);
}

Port::~Port() {
  // A board that hangs on DTR would be reset by letting go of it.
  before_.c_cflag &= ~static_cast<tcflag_t>(HUPCL);
  ::tcsetattr(fd_, TCSANOW, &before_);
  ::ioctl(fd_, TIOCNXCL);
  ::close(fd_);
}

void Port::fail(const char* doing, int error) const {
  throw Error(ErrorCode::device_lost, fmt::format("{}: {}: {}; was it unplugged, or switched off?",
                                                  path_, doing, reason_of(error)));
}

bool Port::wait(short events, std::int64_t until_ns) const {
  for (;;) {
    const std::int64_t left_ns = std::max<std::int64_t>(until_ns - monotonic_now_ns(), 0);
    pollfd wanted{fd_, events, 0};
    const int left_ms = static_cast<int>((left_ns + kMillisecond_ns - 1) / kMillisecond_ns);
    const int ready = ::poll(&wanted, 1, left_ms);
    if (ready < 0 && errno == EINTR) {
      if (left_ns == 0) return false;
      continue;
    }
    if (ready < 0) fail("waiting", errno);
    // What came before it went is read first.
    if (ready > 0 && (wanted.revents & events) == 0) fail("waiting", EIO);
    return ready > 0;
  }
}

void Port::write(const std::string& bytes) {
  const std::int64_t until_ns = monotonic_now_ns() + kWrite_ns;
  for (std::size_t sent = 0; sent < bytes.size();) {
    if (!wait(POLLOUT, until_ns)) {
      throw Error(ErrorCode::timeout, fmt::format("{} takes nothing more", path_));
    }
    const ssize_t count = ::write(fd_, bytes.data() + sent, bytes.size() - sent);
    if (count >= 0) sent += static_cast<std::size_t>(count);
    if (count < 0 && errno != EAGAIN && errno != EINTR) fail("writing", errno);
  }
}

std::optional<std::string> Port::take_line() {
  const std::size_t end = received_.find(line_end_);
  if (end == std::string::npos) {
    if (received_.size() > kLongestLine) received_.erase(0, received_.size() - kLongestLine);
    return std::nullopt;
  }
  std::string line = received_.substr(0, end);
  received_.erase(0, end + line_end_.size());
  std::erase_if(line, [](unsigned char c) { return c < 0x20 || c >= 0x7f; });
  if (line.size() > kLongestLine) line.erase(0, line.size() - kLongestLine);
  return line;
}

std::optional<std::string> Port::read_line(std::int64_t until_ns) {
  for (;;) {
    if (auto line = take_line()) return line;
    if (!wait(POLLIN, until_ns)) return std::nullopt;
    char bytes[256];
    const ssize_t count = ::read(fd_, bytes, sizeof bytes);
    if (count > 0) received_.append(bytes, static_cast<std::size_t>(count));
    if (count == 0) fail("reading", EIO);
    if (count < 0 && errno != EAGAIN && errno != EINTR) fail("reading", errno);
  }
}

}  // namespace fathom::serial
