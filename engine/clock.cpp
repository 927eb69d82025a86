// SPDX-License-Identifier: Apache-2.0
#include "engine/clock.hpp"

#include <chrono>
#include <ctime>

namespace fathom {
namespace {

class MachineClock final : public Clock {
 public:
  double wall_s() const override { return seconds(std::chrono::steady_clock::now()); }
  double processor_s() const override { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
  double calendar_s() const override { return seconds(std::chrono::system_clock::now()); }

 private:
  template <class Time>
  static double seconds(Time time) {
    return std::chrono::duration<double>(time.time_since_epoch()).count();
  }
};

}  // namespace

const Clock& machine_clock() {
  static const MachineClock clock;
  return clock;
}

}  // namespace fathom
