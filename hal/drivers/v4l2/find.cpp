// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/find.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cctype>
#include <optional>

#include "engine/error.hpp"
#include "hal/drivers/v4l2/controls.hpp"
#include "hal/drivers/v4l2/device.hpp"
#include "hal/drivers/v4l2/modes.hpp"

namespace fathom::v4l2 {
namespace {

/// Whether a path is `start` and a number.
bool is_numbered(const std::string& path, std::string_view start) {
  if (!path.starts_with(start) || path.size() == start.size()) return false;
  return std::all_of(path.begin() + static_cast<std::ptrdiff_t>(start.size()), path.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The name that stays the same whatever else is plugged in.
std::string lasting_name(System& system, const std::string& node) {
  for (const std::string& name : system.list("/dev/v4l/by-id")) {
    if (system.resolve(name) == node) return name;
  }
  return node;
}

std::string focus_text(const Device& device) {
  const auto focus = find_control(device, V4L2_CID_FOCUS_ABSOLUTE);
  if (!focus) return "no focus control";
  return fmt::format("focus {} to {}", focus->lowest, focus->highest) +
         (focus->step == 1 ? "" : fmt::format(", step {}", focus->step));
}

/// "GREY, YUYV 640 x 480; MJPEG 1280 x 720": formats with the same sizes together.
std::string formats_text(const Device& device) {
  std::vector<std::string> texts;
  std::string last_sizes;
  for (const PixelFormat* format : offered_formats(device)) {
    std::string sizes = sizes_text(device, *format);
    if (!sizes.empty()) sizes.insert(0, " ");
    std::string names(format->name);
    if (!texts.empty() && sizes == last_sizes) {
      names = fmt::format("{}, {}", texts.back(), names);
      texts.pop_back();
    } else if (!texts.empty()) {
      texts.back() += last_sizes;
    }
    texts.push_back(names);
    last_sizes = sizes;
  }
  if (texts.empty()) return "no format that is read";
  return fmt::format("{}{}", fmt::join(texts, "; "), last_sizes);
}

/// Asks for no buffers, which a free camera grants and does nothing.
std::string problem_of(const Device& device) {
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  return device.attempt(VIDIOC_REQBUFS, none) == EBUSY ? "in use by another program" : "";
}

std::optional<FoundHardware> describe_camera(System& system, const std::string& node,
                                             const Device& device) {
  v4l2_capability capability{};
  if (device.attempt(VIDIOC_QUERYCAP, capability) != 0) return std::nullopt;
  if (!gives_pictures(capability)) return std::nullopt;
  FoundHardware found;
  found.text = "v4l2:" + lasting_name(system, node);
  found.description =
      fmt::format("{} ({}): {}; {}", fixed_text(capability.card, sizeof capability.card), node,
                  formats_text(device), focus_text(device));
  found.has_camera = !offered_formats(device).empty();
  found.has_lens = find_control(device, V4L2_CID_FOCUS_ABSOLUTE).has_value();
  found.problem = problem_of(device);
  return found;
}

std::optional<FoundHardware> describe_lens(const std::string& node, const Device& device) {
  if (!find_control(device, V4L2_CID_FOCUS_ABSOLUTE)) return std::nullopt;
  FoundHardware found;
  found.text = "v4l2:" + node;
  found.description = fmt::format("lens on a sub-device: {}", focus_text(device));
  found.has_lens = true;
  return found;
}

}  // namespace

std::vector<FoundHardware> find_hardware(System& system) {
  std::vector<FoundHardware> all;
  for (const std::string& node : system.list("/dev")) {
    const bool is_camera = is_numbered(node, "/dev/video");
    if (!is_camera && !is_numbered(node, "/dev/v4l-subdev")) continue;
    try {
      const auto device = Device::open(system, node);
      const auto found =
          is_camera ? describe_camera(system, node, *device) : describe_lens(node, *device);
      if (found) all.push_back(*found);
    } catch (const Error& error) {
      all.push_back(
          {"v4l2:" + node, "cannot be asked what it is", is_camera, !is_camera, error.what()});
    }
  }
  return all;
}

}  // namespace fathom::v4l2
