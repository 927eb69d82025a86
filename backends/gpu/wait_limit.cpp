// SPDX-License-Identifier: Apache-2.0
#include "backends/gpu/wait_limit.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <vector>

namespace fathom::gpu {
namespace {

std::optional<double> wished() {
  const char* const text = std::getenv("FATHOM_GPU_TIMEOUT");
  if (text == nullptr || *text == '\0') return std::nullopt;
  const std::string_view number = text;
  double seconds = 0;
  const char* const end = number.data() + number.size();
  const auto [next, problem] = std::from_chars(number.data(), end, seconds);
  if (problem == std::errc() && next == end && std::isfinite(seconds) && seconds > 0) {
    return seconds;
  }
  throw Error(ErrorCode::bad_argument,
              fmt::format("FATHOM_GPU_TIMEOUT is \"{}\"; write seconds, above 0", number));
}

}  // namespace

WaitLimit::WaitLimit(DeviceKind kind)
    : call_s_(kind == DeviceKind::gpu ? 60 : 600), window_s_(kind == DeviceKind::gpu ? 0.001 : 2) {
  if (const auto seconds = wished()) {
    call_s_ = *seconds;
    window_s_ = 0;
  }
}

Error given_up(std::string_view device, double after_s) {
  return {ErrorCode::timeout,
          fmt::format("{} did not answer within {:.3g} s and is given up; make a new plan, or set "
                      "FATHOM_GPU_TIMEOUT to more seconds",
                      device, after_s)};
}

void keep_for_ever(std::shared_ptr<void> object) {
  static std::mutex mutex;
  static auto* const kept = new std::vector<std::shared_ptr<void>>;
  const std::lock_guard lock(mutex);
  kept->push_back(std::move(object));
}

}  // namespace fathom::gpu
