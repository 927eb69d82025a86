// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/device.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>

#include "engine/error.hpp"
#include "hal/drivers/v4l2/controls.hpp"

namespace fathom::v4l2 {
namespace {

/// What a lens takes from end to end, that an automatic focus has just sent somewhere.
constexpr std::int64_t kFocusRest_ns = 500'000'000;

/// How long a device that is busy, or whose bus is disturbed, is asked again, and how often.
constexpr std::int64_t kPatience_ns = 1'000'000'000;
constexpr std::int64_t kAgain_ns = 50'000'000;

bool is_gone(int error) { return error == ENODEV || error == ENXIO || error == ESHUTDOWN; }

/// Errors that come back however often it is tried.
bool is_final(int error) { return error == EINVAL || error == ERANGE || error == ENOTTY; }

std::string reason(int error) { return std::generic_category().message(error); }

/// What the node itself can do; old drivers tell it of the device as a whole.
std::uint32_t abilities(const v4l2_capability& capability) {
  const bool tells_node = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  return tells_node ? capability.device_caps : capability.capabilities;
}

[[noreturn]] void fail_to_open(const std::string& path, int error) {
  std::string problem;
  switch (error) {
    case ENOENT:
      problem = fmt::format("{} is not there; `fathom rigs list` shows what is plugged in", path);
      break;
    case EACCES:
    case EPERM:
      problem = fmt::format(
          "no permission to open {}; join the group video (sudo usermod -aG video $USER) and log "
          "in again",
          path);
      break;
    case EBUSY:
      problem = fmt::format("{} is in use by another program; close it and try again", path);
      break;
    case ENODEV:
    case ENXIO:
      problem = fmt::format("there is no device behind {}; is it plugged in?", path);
      break;
    default:
      problem = fmt::format("cannot open {}: {}", path, reason(error));
  }
  throw Error(ErrorCode::unavailable, problem);
}

}  // namespace

std::string fixed_text(const unsigned char* text, std::size_t size) {
  const char* const start = reinterpret_cast<const char*>(text);
  return {start, ::strnlen(start, size)};
}

bool gives_pictures(const v4l2_capability& capability) {
  constexpr std::uint32_t kNeeded = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  return (abilities(capability) & kNeeded) == kNeeded;
}

bool gives_planes_only(const v4l2_capability& capability) {
  constexpr std::uint32_t kKinds = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE;
  return (abilities(capability) & kKinds) == V4L2_CAP_VIDEO_CAPTURE_MPLANE;
}

std::shared_ptr<Device> Device::open(System& system, const std::string& path) {
  static std::mutex mutex;
  static std::map<std::pair<System*, std::string>, std::weak_ptr<Device>> open_devices;
  const std::lock_guard lock(mutex);
  std::weak_ptr<Device>& entry = open_devices[{&system, system.resolve(path)}];
  // A device that was unplugged keeps its old node until it is closed: the new one is another.
  if (auto device = entry.lock(); device != nullptr && !device->is_lost_) return device;
  int descriptor = system.open(path);
  while (descriptor == -EINTR) descriptor = system.open(path);
  if (descriptor < 0) fail_to_open(path, -descriptor);
  auto device = std::make_shared<Device>(system, path, descriptor);
  entry = device;
  return device;
}

int Device::control(unsigned long request, void* argument) const {
  int error = -system_.ioctl(descriptor_, request, argument);
  while (error == EINTR) error = -system_.ioctl(descriptor_, request, argument);
  if (error == ENODEV || error == ENXIO) is_lost_ = true;
  return error;
}

void Device::call_control(unsigned long request, v4l2_control& argument,
                          std::string_view what) const {
  const v4l2_control wanted = argument;
  const std::int64_t give_up_ns = system_.now_ns() + kPatience_ns;
  int error = control(request, &argument);
  for (; error == EBUSY && system_.now_ns() < give_up_ns; error = control(request, &argument)) {
    system_.sleep_until_ns(system_.now_ns() + kAgain_ns);
    argument = wanted;
  }
  if (error == EBUSY) {
    throw Error(ErrorCode::unavailable,
                fmt::format("{}: {}: it says that it is not ready (does its lens still move, or "
                            "does another program use it?); wait a moment and try again",
                            path_, what));
  }
  if (error != 0) fail(error, what);
}

void Device::put_back(std::vector<std::function<int()>> steps) const noexcept {
  std::optional<std::int64_t> give_up_ns;
  while (!steps.empty()) {
    // A step that waits for an answer may last seconds by itself; the first round is for all.
    std::erase_if(steps, [&](const std::function<int()>& step) {
      if (give_up_ns && system_.now_ns() >= *give_up_ns) return false;
      const int error = step();
      return error == 0 || is_gone(error) || is_final(error);
    });
    const std::int64_t now_ns = system_.now_ns();
    if (!give_up_ns) give_up_ns = now_ns + kPatience_ns;
    if (steps.empty() || now_ns >= *give_up_ns) return;
    system_.sleep_until_ns(now_ns + kAgain_ns);
  }
}

void Device::fail(int error, std::string_view what) const {
  switch (error) {
    case ENODEV:
    case ENXIO:
    case ESHUTDOWN:
      is_lost_ = true;
      throw Error(ErrorCode::device_lost,
                  fmt::format("{} was unplugged: {}; plug it in and start again", path_, what));
    case EBUSY:
      throw Error(
          ErrorCode::unavailable,
          fmt::format("{} is in use by another program: {}; close it and try again", path_, what));
    case ENOSPC:
      throw Error(ErrorCode::unavailable,
                  fmt::format("{}: {}: its bus has no bandwidth left; ask for a smaller picture or "
                              "fewer fps, or plug it in elsewhere",
                              path_, what));
    case ETIMEDOUT:
      throw Error(ErrorCode::timeout, fmt::format("{}: {}: no answer from the device; plug it out "
                                                  "and in again",
                                                  path_, what));
    default:
      throw Error(ErrorCode::io, fmt::format("{}: {}: the device or its driver refuses ({})", path_,
                                             what, reason(error)));
  }
}

std::shared_ptr<ControlGuard> Device::hold_focus(const std::shared_ptr<Device>& self) {
  auto guard = focus_.lock();
  if (guard == nullptr) {
    guard = std::make_shared<ControlGuard>(self);
    switch_off_automatic_focus(*guard);
    // It may have been on its way, and whoever opens the device now takes the lens to be at rest.
    if (guard->has_changed_anything()) system_.sleep_until_ns(system_.now_ns() + kFocusRest_ns);
    focus_ = guard;
  }
  return guard;
}

}  // namespace fathom::v4l2
