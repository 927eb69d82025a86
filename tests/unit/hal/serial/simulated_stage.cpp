// SPDX-License-Identifier: Apache-2.0
#include "simulated_stage.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "hal/clock.hpp"

namespace fathom::test {

double StageMotor::within(const Leg& leg, std::int64_t time_ns) const {
  const double way = rate_ * static_cast<double>(time_ns - leg.since_ns) * 1e-9;
  const double whole = leg.to - leg.from;
  return std::abs(whole) <= way ? leg.to : leg.from + std::copysign(std::max(way, 0.0), whole);
}

double StageMotor::position_at(std::int64_t time_ns) const {
  const std::lock_guard lock(mutex_);
  const auto after = std::find_if(legs_.begin(), legs_.end(),
                                  [&](const Leg& leg) { return leg.since_ns > time_ns; });
  return after == legs_.begin() ? legs_.front().from : within(*(after - 1), time_ns);
}

double StageMotor::position() const { return position_at(monotonic_now_ns()); }

double StageMotor::mean(std::int64_t start_ns, std::int64_t end_ns) const {
  constexpr int kParts = 64;
  double sum = 0;
  for (int i = 0; i < kParts; ++i) {
    sum += position_at(start_ns + (end_ns - start_ns) * (2 * i + 1) / (2 * kParts));
  }
  return sum / kParts;
}

void StageMotor::go_to(double target) {
  const std::int64_t now_ns = monotonic_now_ns();
  const double from = position_at(now_ns);
  const std::lock_guard lock(mutex_);
  legs_.push_back({now_ns, from, target});
}

void StageMotor::halt() { go_to(position()); }

void StageMotor::set(double position) {
  const std::lock_guard lock(mutex_);
  legs_.push_back({monotonic_now_ns(), position, position});
}

bool StageMotor::is_moving() const {
  const double now = position();
  const std::lock_guard lock(mutex_);
  return now != legs_.back().to;
}

SimulatedStage::SimulatedStage(std::shared_ptr<StageMotor> motor, std::unique_ptr<Dialect> dialect)
    : motor_(std::move(motor)), dialect_(std::move(dialect)) {
  char name[128] = {};
  termios raw{};
  ::cfmakeraw(&raw);
  // The keeper holds the terminal open between two programs, as a plugged-in cable does.
  if (::openpty(&terminal_, &keeper_, name, &raw, nullptr) != 0) {
    throw std::runtime_error("no pseudo-terminal");
  }
  // A program that is started meanwhile would keep the cable plugged in.
  for (const int end : {terminal_, keeper_}) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  port_ = name;
  thread_ = std::thread([this] { serve(); });
}

SimulatedStage::~SimulatedStage() {
  ends_ = true;
  thread_.join();
  unplug();
}

void SimulatedStage::unplug() {
  const std::lock_guard lock(mutex_);
  if (keeper_ >= 0) ::close(keeper_);
  if (terminal_ >= 0) ::close(terminal_);
  keeper_ = terminal_ = -1;
}

void SimulatedStage::set_faults(const LineFaults& faults) {
  const std::lock_guard lock(mutex_);
  faults_ = faults;
}

void SimulatedStage::say(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (terminal_ < 0) return;
  [[maybe_unused]] const ssize_t written = ::write(terminal_, text.data(), text.size());
}

std::vector<std::string> SimulatedStage::heard() const {
  const std::lock_guard lock(mutex_);
  return heard_;
}

void SimulatedStage::take(const std::string& line) {
  LineFaults faults;
  {
    const std::lock_guard lock(mutex_);
    heard_.push_back(line);
    faults = faults_;
  }
  std::string answer = dialect_->answer(line);
  if (faults.delay_ns > 0) sleep_until_ns(monotonic_now_ns() + faults.delay_ns);
  if (faults.echoes) say(line + std::string(1, dialect_->end()));
  if (answer.empty()) return;
  if (faults.drops_every > 0 && ++answers_ % faults.drops_every == 0) return;
  say(faults.noise + answer);
}

void SimulatedStage::serve() {
  std::string received;
  while (!ends_) {
    if (const std::string text = dialect_->unasked(); !text.empty()) say(text);
    int terminal = -1;
    {
      const std::lock_guard lock(mutex_);
      terminal = terminal_;
    }
    if (terminal < 0) return;
    pollfd wanted{terminal, POLLIN, 0};
    if (::poll(&wanted, 1, 2) <= 0) continue;
    char bytes[256];
    const ssize_t count = ::read(terminal, bytes, sizeof bytes);
    for (ssize_t i = 0; i < count; ++i) {
      if (bytes[i] == dialect_->end()) {
        if (!received.empty()) take(received);
        received.clear();
      } else if (dialect_->is_alone(bytes[i])) {
        take(std::string(1, bytes[i]));
      } else if (bytes[i] != '\r' && bytes[i] != '\n') {
        received += bytes[i];
      }
    }
  }
}

std::unique_ptr<SimulatedStage> make_stage(const std::string& profile, double rate) {
  auto motor = std::make_shared<StageMotor>(rate);
  auto dialect = make_dialect(profile, *motor);
  return std::make_unique<SimulatedStage>(std::move(motor), std::move(dialect));
}

}  // namespace fathom::test
