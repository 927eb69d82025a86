// SPDX-License-Identifier: Apache-2.0
// Data lines of a parallel port through Linux' ppdev.
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/parport.h>
#include <linux/ppdev.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "engine/error.hpp"
#include "hal/drivers/stepper/lines.hpp"

namespace fathom::stepper {
namespace {

constexpr int kMostPorts = 8;  // what Linux has by default

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

struct StatusLine {
  std::string_view name;
  unsigned char mask;
  bool is_inverted;  ///< The port's hardware shows the opposite of the pin's level.
};
constexpr StatusLine kStatus[] = {{"ack", PARPORT_STATUS_ACK, false},
                                  {"busy", PARPORT_STATUS_BUSY, true},
                                  {"paper", PARPORT_STATUS_PAPEROUT, false},
                                  {"select", PARPORT_STATUS_SELECT, false},
                                  {"error", PARPORT_STATUS_ERROR, false}};

const StatusLine* status_line(std::string_view name) {
  for (const StatusLine& line : kStatus) {
    if (line.name == name) return &line;
  }
  return nullptr;
}

/// A port of one's own. The kernel gives it back when it is closed.
class Port {
 public:
  explicit Port(const std::string& path) : path_(path) {
    fd_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (fd_ < 0) throw Error(ErrorCode::unavailable, why_not_opened(errno));
    // Exclusive, or a printer's driver could write between two steps.
    const bool is_ours = ::ioctl(fd_, PPEXCL) == 0 && ::ioctl(fd_, PPCLAIM) == 0;
    if (is_ours) return;
    const int problem = errno;
    ::close(fd_);
    throw Error(ErrorCode::unavailable,
                fmt::format("cannot claim {}: {}; is it in use by another program or by the "
                            "printer's driver (try: rmmod lp)",
                            path, reason_of(problem)));
  }
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  ~Port() {
    ::ioctl(fd_, PPRELEASE);
    ::close(fd_);
  }

  template <class Argument>
  void control(unsigned long request, Argument* argument, const char* what) const {
    if (::ioctl(fd_, request, argument) == 0) return;
    throw Error(ErrorCode::device_lost,
                fmt::format("cannot {} {}: {}", what, path_, reason_of(errno)));
  }

 private:
  std::string why_not_opened(int problem) const {
    if (problem == ENOENT) {
      return fmt::format(
          "there is no {}; write port = \"gpio\" or the path of a parallel port "
          "(first in a rig text), and load its driver: modprobe parport_pc ppdev",
          path_);
    }
    if (problem == EACCES) {
      return fmt::format("no permission to open {}; add yourself to its group (lp) and log in anew",
                         path_);
    }
    return fmt::format("cannot open {}: {}", path_, reason_of(problem));
  }

  std::string path_;
  int fd_ = -1;
};

class ParallelLines final : public Lines {
 public:
  ParallelLines(const ParallelPins& pins, StepRest rest)
      : pins_(pins), rest_(rest), home_(status_line(pins.home)), port_(pins.path) {
    std::error_code ignored;
    const auto path = std::filesystem::canonical(pins.path, ignored);
    name_ = fmt::format("parallel port {}, step D{}, direction D{}",
                        ignored ? pins.path : path.string(), pins.step_bit, pins.direction_bit);
    int forward = 0;
    port_.control(PPDATADIR, &forward, "set the direction of");
    port_.control(PPRDATA, &data_, "read");
    direction_found_ = data_ & bit(pins.direction_bit);
    if (rest) write_step(*rest);
    step_at_open_ = data_ & bit(pins.step_bit);
  }

  ~ParallelLines() override {
    try {
      if (rest_) write_step(*rest_);
      write_direction(direction_found_);
    } catch (const Error&) {  // the port is gone, and its wires with it
    }
  }

  std::string name() const override { return name_; }
  bool step_at_open() const override { return step_at_open_; }
  void write_step(bool high) override { write(pins_.step_bit, high); }
  void write_direction(bool high) override { write(pins_.direction_bit, high); }
  bool has_home_switch() const override { return home_ != nullptr; }

  bool read_home_switch() override {
    unsigned char status = 0;
    port_.control(PPRSTATUS, &status, "read the status of");
    return ((status & home_->mask) != 0) != home_->is_inverted;
  }

 private:
  static unsigned char bit(int index) { return static_cast<unsigned char>(1U << index); }

  /// The other bits stay as they were found: the port is ours alone, nobody else changes them.
  void write(int index, bool high) {
    const int wanted = high ? data_ | bit(index) : data_ & ~bit(index);
    unsigned char data = static_cast<unsigned char>(wanted);
    if (data == data_) return;
    port_.control(PPWDATA, &data, "write to");
    data_ = data;
  }

  ParallelPins pins_;
  StepRest rest_;
  const StatusLine* home_;
  Port port_;
  std::string name_;
  unsigned char data_ = 0;  // what stands on the data lines
  bool direction_found_ = false;
  bool step_at_open_ = false;
};

}  // namespace

std::unique_ptr<Lines> open_parallel_port(const ParallelPins& pins, StepRest rest) {
  return std::make_unique<ParallelLines>(pins, rest);
}

std::vector<FoundHardware> find_parallel_ports() {
  std::vector<FoundHardware> found;
  for (int i = 0; i < kMostPorts; ++i) {
    const std::string path = fmt::format("/dev/parport{}", i);
    if (::access(path.c_str(), F_OK) != 0) continue;
    FoundHardware port{"stepper:" + path, "parallel port: STEP on D0 (pin 2), DIR on D1 (pin 3)",
                       false, true, ""};
    if (::access(path.c_str(), R_OK | W_OK) != 0) {
      port.problem = "no permission; add yourself to its group (lp) and log in anew";
    }
    found.push_back(port);
  }
  return found;
}

}  // namespace fathom::stepper
