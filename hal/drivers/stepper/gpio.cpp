// SPDX-License-Identifier: Apache-2.0
// Lines of a GPIO chip through libgpiod (1.6).
#include <fmt/format.h>
#include <gpiod.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "engine/error.hpp"
#include "hal/drivers/stepper/lines.hpp"

namespace fathom::stepper {
namespace {

constexpr const char* kConsumer = "fathom";

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }  // releases its lines too
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

Chip open_chip(const std::string& name) {
  Chip chip(gpiod_chip_open_lookup(name.c_str()));
  if (chip != nullptr) return chip;
  const int problem = errno;
  if (problem == EACCES || problem == EPERM) {
    throw Error(ErrorCode::unavailable,
                fmt::format("no permission to open the GPIO chip {}; add yourself to the group of "
                            "/dev/gpiochip* (gpio) and log in anew",
                            name));
  }
  throw Error(ErrorCode::unavailable,
              fmt::format("no GPIO chip {}: {}; chip takes a name, path or label, and fathom rigs "
                          "list shows them",
                          name, reason_of(problem)));
}

/// A line by its number, or by its name.
gpiod_line* find_line(gpiod_chip* chip, const std::string& wanted) {
  unsigned number = 0;
  const char* const end = wanted.data() + wanted.size();
  const auto [next, problem] = std::from_chars(wanted.data(), end, number);
  const bool is_number = problem == std::errc() && next == end;
  if (is_number && number < gpiod_chip_num_lines(chip)) {
    if (gpiod_line* line = gpiod_chip_get_line(chip, number)) return line;
  } else if (!is_number) {
    if (gpiod_line* line = gpiod_chip_find_line(chip, wanted.c_str())) return line;
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("{} ({}) has no line {}; it has the numbers 0 to {}",
                          gpiod_chip_name(chip), gpiod_chip_label(chip), wanted,
                          static_cast<int>(gpiod_chip_num_lines(chip)) - 1));
}

std::string line_name(gpiod_line* line) { return fmt::format("line {}", gpiod_line_offset(line)); }

/// Asks the kernel for a line.
void request(gpiod_line* line, int type, int flags, bool level) {
  const gpiod_line_request_config config{kConsumer, type, flags};
  if (gpiod_line_request(line, &config, level ? 1 : 0) == 0) return;
  const int problem = errno;
  const char* const consumer = gpiod_line_consumer(line);
  throw Error(ErrorCode::unavailable,
              problem == EBUSY
                  ? fmt::format("GPIO {} is in use by {}; end it, or use another line",
                                line_name(line), consumer != nullptr ? consumer : "the kernel")
                  : fmt::format("cannot use GPIO {}: {}", line_name(line), reason_of(problem)));
}

bool read_level(gpiod_line* line) {
  const int value = gpiod_line_get_value(line);
  if (value >= 0) return value != 0;
  throw Error(ErrorCode::device_lost,
              fmt::format("cannot read GPIO {}: {}", line_name(line), reason_of(errno)));
}

/// The level of a line that nobody uses, without a change to it.
bool found_level(gpiod_line* line) {
  request(line, GPIOD_LINE_REQUEST_DIRECTION_AS_IS, 0, false);
  const bool level = read_level(line);
  gpiod_line_release(line);
  return level;
}

int pull_flag(const std::string& pull) {
  return pull == "up"     ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP
         : pull == "down" ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN
                          : GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
}

class GpioLines final : public Lines {
 public:
  GpioLines(const GpioPins& pins, StepRest rest)
      : chip_(open_chip(pins.chip)),
        step_(find_line(chip_.get(), pins.step)),
        direction_(find_line(chip_.get(), pins.direction)),
        home_(pins.home.empty() ? nullptr : find_line(chip_.get(), pins.home)),
        rest_(rest) {
    if (step_ == direction_ || step_ == home_ || direction_ == home_) {
      throw Error(ErrorCode::bad_argument,
                  fmt::format("step, dir and home must be three lines; {} is named twice",
                              line_name(step_ == direction_ ? direction_ : home_)));
    }
    step_at_open_ = rest_.value_or(false);
    if (!rest_) step_at_open_ = found_level(step_);
    direction_found_ = found_level(direction_);
    request(step_, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, 0, step_at_open_);
    request(direction_, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, 0, direction_found_);
    if (home_ != nullptr) {
      request(home_, GPIOD_LINE_REQUEST_DIRECTION_INPUT, pull_flag(pins.home_pull), false);
    }
    reads_back_ = shows_its_levels();
  }

  ~GpioLines() override {
    if (rest_) gpiod_line_set_value(step_, *rest_ ? 1 : 0);
    gpiod_line_set_value(direction_, direction_found_ ? 1 : 0);
  }

  /// The label too, because numbers are given anew at every start of the computer.
  std::string name() const override {
    return fmt::format("{} ({}), step {}, direction {}", gpiod_chip_name(chip_.get()),
                       gpiod_chip_label(chip_.get()), line_name(step_), line_name(direction_));
  }
  bool step_at_open() const override { return step_at_open_; }
  void write_step(bool high) override { write(step_, high); }
  void write_direction(bool high) override { write(direction_, high); }
  bool has_home_switch() const override { return home_ != nullptr; }
  bool read_home_switch() override { return read_level(home_); }

 private:
  /// The kernel does not say whether a chip at the end of a cable took a level; most show it.
  void write(gpiod_line* line, bool high) const {
    if (gpiod_line_set_value(line, high ? 1 : 0) != 0) {
      throw Error(ErrorCode::device_lost,
                  fmt::format("cannot write GPIO {}: {}", line_name(line), reason_of(errno)));
    }
    if (!reads_back_ || read_level(line) == high) return;
    throw Error(ErrorCode::device_lost,
                fmt::format("GPIO {} did not take its level; look at the chip's cable, and whether "
                            "something else drives the wire",
                            line_name(line)));
  }

  /// Whether an output of this chip can be read. DIR may be changed to find out: without a step it
  /// means nothing.
  bool shows_its_levels() const {
    for (const bool level : {!direction_found_, direction_found_}) {
      write(direction_, level);
      if (gpiod_line_get_value(direction_) != (level ? 1 : 0)) {
        write(direction_, direction_found_);
        return false;
      }
    }
    return true;
  }

  Chip chip_;
  gpiod_line* step_;
  gpiod_line* direction_;
  gpiod_line* home_;
  StepRest rest_;
  bool step_at_open_ = false;
  bool direction_found_ = false;
  bool reads_back_ = false;
};

FoundHardware describe(const std::string& device) {
  const std::string name = device.substr(device.rfind('/') + 1);
  FoundHardware found{fmt::format("stepper:port=gpio,chip={},step=LINE,dir=LINE", name),
                      "GPIO chip", false, true,
                      "LINE stands for the two lines that the driver board is wired to"};
  if (::access(device.c_str(), R_OK | W_OK) != 0) {
    found.problem = "no permission; add yourself to its group (gpio) and log in anew";
    return found;
  }
  const Chip chip(gpiod_chip_open(device.c_str()));
  if (chip == nullptr) {
    found.problem = fmt::format("cannot be opened: {}", reason_of(errno));
    return found;
  }
  found.description = fmt::format("GPIO chip {}, {} lines", gpiod_chip_label(chip.get()),
                                  gpiod_chip_num_lines(chip.get()));
  return found;
}

}  // namespace

std::unique_ptr<Lines> open_gpio(const GpioPins& pins, StepRest rest) {
  return std::make_unique<GpioLines>(pins, rest);
}

std::vector<FoundHardware> find_gpio_chips() {
  std::vector<std::string> devices;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", ignored)) {
    const std::string path = entry.path().string();
    if (path.starts_with("/dev/gpiochip")) devices.push_back(path);
  }
  std::sort(devices.begin(), devices.end());
  std::vector<FoundHardware> found;
  found.reserve(devices.size());
  for (const std::string& device : devices) found.push_back(describe(device));
  return found;
}

}  // namespace fathom::stepper
