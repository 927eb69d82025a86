// SPDX-License-Identifier: Apache-2.0
#include "hal/clock.hpp"

#include <cerrno>
#include <ctime>

namespace fathom {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

std::int64_t monotonic_now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond_ns + now.tv_nsec;
}

void sleep_until_ns(std::int64_t time_ns) {
  const timespec until{time_ns / kSecond_ns, time_ns % kSecond_ns};
  while (time_ns > 0 && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace fathom
