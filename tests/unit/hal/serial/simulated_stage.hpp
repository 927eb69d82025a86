// SPDX-License-Identifier: Apache-2.0
// A motor behind a pseudo-terminal that speaks one of the dialects of the profiles, written from the
// devices' manuals, with the faults that real ones have.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace fathom::test {

/// The motor itself: it goes to its target at a constant rate. Times on the computer's clock.
class StageMotor {
 public:
  explicit StageMotor(double rate) : rate_(rate) {}

  void go_to(double target);
  void halt();
  /// Somebody turned it, or it was reset: it says from now on that it is here.
  void set(double position);
  double position() const;
  /// The same for any moment since it was made, and the mean over a time.
  double position_at(std::int64_t time_ns) const;
  double mean(std::int64_t start_ns, std::int64_t end_ns) const;
  bool is_moving() const;
  double rate() const { return rate_; }

 private:
  struct Leg {
    std::int64_t since_ns;
    double from, to;
  };
  double within(const Leg& leg, std::int64_t time_ns) const;

  mutable std::mutex mutex_;
  double rate_;
  std::vector<Leg> legs_{{0, 0, 0}};
};

/// What a dialect says to bytes that come. It may keep a part of a line for later.
class Dialect {
 public:
  virtual ~Dialect() = default;
  virtual std::string answer(const std::string& line) = 0;
  /// What ends a command.
  virtual char end() const { return '\n'; }
  /// A command of one byte that needs no end.
  virtual bool is_alone(char) const { return false; }
  /// Said when it is switched on or reset.
  virtual std::string greeting() const { return {}; }
  /// Said now and then without being asked.
  virtual std::string unasked() { return {}; }
};

/// What goes wrong on the line.
struct LineFaults {
  bool echoes = false;
  std::string noise = {};     ///< Before every answer.
  int drops_every = 0;        ///< Each n-th answer gets lost; 0: none.
  std::int64_t delay_ns = 0;  ///< Before every answer.
};

class SimulatedStage {
 public:
  SimulatedStage(std::shared_ptr<StageMotor> motor, std::unique_ptr<Dialect> dialect);
  ~SimulatedStage();

  /// The path of the terminal.
  const std::string& port() const { return port_; }
  StageMotor& motor() { return *motor_; }
  std::shared_ptr<StageMotor> shared_motor() { return motor_; }
  void set_faults(const LineFaults& faults);
  /// Says something now.
  void say(const std::string& text);
  /// The cable is pulled.
  void unplug();
  /// Every command that came.
  std::vector<std::string> heard() const;

 private:
  void serve();
  void take(const std::string& line);

  std::shared_ptr<StageMotor> motor_;
  std::unique_ptr<Dialect> dialect_;
  int terminal_ = -1, keeper_ = -1;
  std::string port_;
  mutable std::mutex mutex_;
  LineFaults faults_;
  std::vector<std::string> heard_;
  int answers_ = 0;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

/// name: of a profile. Throws std::invalid_argument for one that nobody has written a device for.
std::unique_ptr<Dialect> make_dialect(const std::string& name, StageMotor& motor);

/// A device on a terminal of its own. rate: what it counts a second.
std::unique_ptr<SimulatedStage> make_stage(const std::string& profile, double rate);

}  // namespace fathom::test
