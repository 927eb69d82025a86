// SPDX-License-Identifier: Apache-2.0
// The dialects of the profiles, as their manuals describe them.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "simulated_stage.hpp"

namespace fathom::test {
namespace {

constexpr double kTravel = 500;

/// The number behind a text within a line; NaN if it is not there.
double number_after(const std::string& line, const std::string& text) {
  const auto at = line.find(text);
  return at == std::string::npos ? std::nan("") : std::atof(line.c_str() + at + text.size());
}

class Grbl final : public Dialect {
 public:
  explicit Grbl(StageMotor& motor) : motor_(motor) {}
  std::string greeting() const override { return "\r\nGrbl 1.1h ['$' for help]\r\n"; }
  bool is_alone(char c) const override { return c == '?' || c == '!' || c == '~' || c == '\x85'; }

  std::string answer(const std::string& line) override {
    if (is_homing_) return {};  // it listens to nothing meanwhile
    if (line == "?") return status();
    if (line == "\x85") return motor_.halt(), std::string();
    if (line == "$H") return is_homing_ = true, motor_.go_to(0), std::string();
    if (is_locked_) return "error:9\r\n";
    if (!line.starts_with("$J=")) return "error:20\r\n";
    const double target = number_after(line, "Z");
    if (std::isnan(target) || line.find('F') == std::string::npos) return "error:22\r\n";
    if (target > kTravel || target < -kTravel) return "error:15\r\n";
    if (target == 66) return alarm();
    return motor_.go_to(target), "ok\r\n";
  }

  std::string unasked() override {
    if (!is_homing_ || motor_.is_moving()) return {};
    is_homing_ = is_locked_ = false;
    return "ok\r\n";
  }

 private:
  /// A hard limit in the way.
  std::string alarm() {
    is_locked_ = true;
    motor_.halt();
    return "ok\r\nALARM:1\r\n[MSG:Reset to continue]\r\n";
  }

  std::string status() const {
    const char* const state = is_locked_ ? "Alarm" : motor_.is_moving() ? "Jog" : "Idle";
    return fmt::format("<{}|MPos:0.000,0.000,{:.3f}|FS:0,0|Ov:100,100,100>\r\n", state,
                       motor_.position());
  }

  StageMotor& motor_;
  bool is_locked_ = false, is_homing_ = false;
};

class Marlin final : public Dialect {
 public:
  explicit Marlin(StageMotor& motor) : motor_(motor) {}
  std::string greeting() const override { return "start\necho:Marlin 2.1\n"; }

  std::string answer(const std::string& line) override {
    if (line.starts_with("G1 Z")) return motor_.go_to(number_after(line, "Z")), "ok\n";
    if (line.starts_with("G28")) return waits_ = true, motor_.go_to(0), std::string();
    if (line == "G21" || line == "G90") return "ok\n";
    if (line == "M410") return motor_.halt(), "ok\n";
    if (line == "M400") return waits_ = true, std::string();
    if (line != "M114") return "echo:Unknown command: \"" + line + "\"\nok\n";
    return fmt::format("X:0.00 Y:0.00 Z:{:.2f} E:0.00 Count X:0 Y:0 Z:0\nok\n", motor_.position());
  }

  std::string unasked() override {
    if (!waits_ || motor_.is_moving()) return {};
    waits_ = false;
    return "ok\n";
  }

 private:
  StageMotor& motor_;
  bool waits_ = false;
};

class Zaber final : public Dialect {
 public:
  explicit Zaber(StageMotor& motor) : motor_(motor) {}

  std::string answer(const std::string& line) override {
    if (!line.starts_with("/1 1")) return {};
    const std::string command = line.size() > 5 ? line.substr(5) : "";
    if (command == "home") return has_reference_ = true, motor_.go_to(0), reply("0");
    if (command == "stop") return motor_.halt(), reply("0");
    if (command == "get pos") return reply(fmt::format("{:.0f}", motor_.position()));
    if (command == "get limit.min") return reply("0");
    if (command == "get limit.max") return reply(fmt::format("{:.0f}", kTravel));
    if (command.empty()) return reply("0");
    if (!command.starts_with("move abs ")) return reject("BADCOMMAND");
    const double target = number_after(command, "abs ");
    if (target < 0 || target > kTravel) return reject("BADDATA");
    if (!has_reference_) return reject("BADAXIS");
    return motor_.go_to(target), reply("0");
  }

 private:
  const char* state() const { return motor_.is_moving() ? "BUSY" : "IDLE"; }
  std::string reply(const std::string& data) const {
    return fmt::format("@01 1 OK {} {} {}\r\n", state(), has_reference_ ? "--" : "WR", data);
  }
  std::string reject(const char* why) const {
    return fmt::format("@01 1 RJ {} -- {}\r\n", state(), why);
  }

  StageMotor& motor_;
  bool has_reference_ = false;
};

class Pi final : public Dialect {
 public:
  explicit Pi(StageMotor& motor) : motor_(motor) {}
  bool is_alone(char c) const override { return c == '\x05'; }

  std::string answer(const std::string& line) override {
    if (line == "\x05") return motor_.is_moving() ? "1\n" : "0\n";
    if (line == "ERR?") return fmt::format("{}\n", std::exchange(error_, 0));
    if (line == "POS? 1") return fmt::format("1={:.6f}\n", motor_.position());
    if (line == "TMN? 1") return "1=0.000000\n";
    if (line == "TMX? 1") return fmt::format("1={:.6f}\n", kTravel);
    if (line == "FRF? 1") return has_reference_ ? "1=1\n" : "1=0\n";
    if (line == "FRF 1") has_reference_ = true, motor_.go_to(0);
    if (line == "HLT 1") motor_.halt(), error_ = 10;
    if (line.starts_with("MOV 1 ")) move(number_after(line, "MOV 1 "));
    return {};
  }

 private:
  void move(double target) {
    if (!has_reference_) {
      error_ = 5;
    } else if (target < 0 || target > kTravel) {
      error_ = 7;
    } else {
      motor_.go_to(target);
    }
  }

  StageMotor& motor_;
  int error_ = 0;
  bool has_reference_ = false;
};

class Asi final : public Dialect {
 public:
  explicit Asi(StageMotor& motor) : motor_(motor) {}
  char end() const override { return '\r'; }

  std::string answer(const std::string& line) override {
    if (line == "/") return motor_.is_moving() ? "B\r\n" : "N\r\n";
    if (line == "\\") return motor_.is_moving() ? (motor_.halt(), ":N-21\r\n") : ":A\r\n";
    if (line == "W Z") return fmt::format(":A {:.1f} \r\n", motor_.position());
    if (line.starts_with("M Z=")) return motor_.go_to(number_after(line, "=")), ":A \r\n";
    return ":N-1\r\n";
  }

 private:
  StageMotor& motor_;
};

class Prior final : public Dialect {
 public:
  explicit Prior(StageMotor& motor) : motor_(motor) {}
  char end() const override { return '\r'; }

  std::string answer(const std::string& line) override {
    if (line == "COMP 0") return "0\r";
    if (line == "$,Z") return motor_.is_moving() ? "4\r" : "0\r";
    if (line == "PZ") return fmt::format("{:.0f}\r", motor_.position());
    if (line == "I") return motor_.halt(), "R\r";
    if (line.starts_with("V,")) return motor_.go_to(number_after(line, ",")), "R\r";
    return "E,8\r";
  }

 private:
  StageMotor& motor_;
};

class Moonlite final : public Dialect {
 public:
  explicit Moonlite(StageMotor& motor) : motor_(motor) {}
  char end() const override { return '#'; }

  std::string answer(const std::string& line) override {
    if (line == ":GI") return motor_.is_moving() ? "01#" : "00#";
    if (line == ":GP") return fmt::format("{:04X}#", std::lround(motor_.position()));
    if (line == ":FQ") motor_.halt();
    if (line == ":FG") motor_.go_to(target_);
    if (line.starts_with(":SN"))
      target_ = static_cast<double>(std::strtol(line.c_str() + 3, nullptr, 16));
    return {};
  }

 private:
  StageMotor& motor_;
  double target_ = 0;
};

class Sketch final : public Dialect {
 public:
  explicit Sketch(StageMotor& motor) : motor_(motor) {}
  std::string greeting() const override { return "focus motor 1\r\n"; }

  std::string answer(const std::string& line) override {
    if (line == "?") {
      return fmt::format("at {:.0f} {}\r\n", motor_.position(),
                         motor_.is_moving() ? "moving" : "still");
    }
    if (line == "S") return motor_.halt(), "ok\r\n";
    if (line.starts_with("G ")) return motor_.go_to(number_after(line, "G ")), "ok\r\n";
    return "no: what?\r\n";
  }

 private:
  StageMotor& motor_;
};

}  // namespace

std::unique_ptr<Dialect> make_dialect(const std::string& name, StageMotor& motor) {
  if (name == "grbl") return std::make_unique<Grbl>(motor);
  if (name == "marlin") return std::make_unique<Marlin>(motor);
  if (name == "zaber") return std::make_unique<Zaber>(motor);
  if (name == "pi") return std::make_unique<Pi>(motor);
  if (name == "asi") return std::make_unique<Asi>(motor);
  if (name == "prior") return std::make_unique<Prior>(motor);
  if (name == "moonlite") return std::make_unique<Moonlite>(motor);
  if (name == "sketch") return std::make_unique<Sketch>(motor);
  throw std::invalid_argument("no dialect " + name);
}

}  // namespace fathom::test
