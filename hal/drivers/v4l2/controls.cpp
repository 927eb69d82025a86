// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/v4l2/controls.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom::v4l2 {
namespace {

/// An automatic, and the values that mean off, best first.
struct Automatic {
  std::uint32_t id;
  std::vector<std::int32_t> off;
};

/// `consequence`: the end of the message, for one that stays on.
void switch_off(ControlGuard& guard, const Automatic& automatic, std::string_view consequence) {
  const auto control = find_control(guard.device(), automatic.id);
  if (!control || control->is_inactive) return;
  const auto is_off = [&](std::int32_t value) {
    return std::find(automatic.off.begin(), automatic.off.end(), value) != automatic.off.end();
  };
  if (is_off(read_control(guard.device(), *control))) return;
  std::string problem = "it stays on";
  for (const std::int32_t off : automatic.off) {
    if (off < control->lowest || off > control->highest) continue;
    try {
      if (is_off(guard.set(*control, off))) return;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::device_lost) throw;
      problem = error.what();
    }
  }
  throw Error(ErrorCode::io,
              fmt::format("{}: cannot switch off \"{}\" ({}){}", guard.device().path(),
                          control->name, problem, consequence));
}

}  // namespace

std::int32_t Control::nearest(double value) const {
  const double within = std::clamp<double>(value, lowest, highest);
  const double last = std::floor((static_cast<double>(highest) - lowest) / step);
  const double steps = std::ceil((within - lowest) / step - 0.5);
  return static_cast<std::int32_t>(lowest + std::clamp(steps, 0.0, last) * step);
}

std::optional<Control> find_control(const Device& device, std::uint32_t id) {
  v4l2_queryctrl query{};
  query.id = id;
  if (device.attempt(VIDIOC_QUERYCTRL, query) != 0) return std::nullopt;
  if ((query.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY)) != 0 ||
      query.minimum > query.maximum) {
    return std::nullopt;
  }
  Control control;
  control.id = id;
  control.name = fixed_text(query.name, sizeof query.name);
  control.lowest = query.minimum;
  control.highest = query.maximum;
  control.step = std::max(query.step, 1);
  control.is_inactive = (query.flags & V4L2_CTRL_FLAG_INACTIVE) != 0;
  return control;
}

std::int32_t read_control(const Device& device, const Control& control, std::string_view when) {
  v4l2_control value{control.id, 0};
  device.call_control(VIDIOC_G_CTRL, value,
                      fmt::format("cannot read \"{}\"{}", control.name, when));
  return value.value;
}

void ControlGuard::remember(const Control& control) {
  const bool is_known = std::any_of(found_.begin(), found_.end(),
                                    [&](const Found& found) { return found.id == control.id; });
  if (!is_known) found_.push_back({control.id, read_control(*device_, control)});
}

std::int32_t ControlGuard::set(const Control& control, std::int32_t value) {
  remember(control);
  v4l2_control wanted{control.id, value};
  device_->call_control(VIDIOC_S_CTRL, wanted,
                        fmt::format("cannot set \"{}\" to {}", control.name, value));
  return read_control(*device_, control);
}

ControlGuard::~ControlGuard() {
  std::vector<std::function<int()>> steps;
  for (auto found = found_.rbegin(); found != found_.rend(); ++found) {
    steps.emplace_back([this, value = v4l2_control{found->id, found->value}] {
      v4l2_control wanted = value;
      return device_->attempt(VIDIOC_S_CTRL, wanted);
    });
  }
  device_->put_back(std::move(steps));
}

void switch_off_automatics(ControlGuard& guard) {
  // The priority is only active while exposure is automatic, so it goes first and comes back last.
  static const Automatic automatics[] = {
      {V4L2_CID_EXPOSURE_AUTO_PRIORITY, {0}},
      {V4L2_CID_EXPOSURE_AUTO, {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY}},
      {V4L2_CID_ISO_SENSITIVITY_AUTO, {V4L2_ISO_SENSITIVITY_MANUAL}},
      {V4L2_CID_AUTOGAIN, {0}},
      {V4L2_CID_AUTO_WHITE_BALANCE, {0}},
      {V4L2_CID_AUTO_N_PRESET_WHITE_BALANCE, {V4L2_WHITE_BALANCE_MANUAL}},
      {V4L2_CID_AUTOBRIGHTNESS, {0}},
      {V4L2_CID_HUE_AUTO, {0}},
      {V4L2_CID_CHROMA_AGC, {0}},
      {V4L2_CID_WIDE_DYNAMIC_RANGE, {0}},
      {V4L2_CID_IMAGE_STABILIZATION, {0}},
  };
  for (const Automatic& automatic : automatics) {
    switch_off(guard, automatic,
               ", and a picture that changes by itself cannot be measured; automatics=leave "
               "measures all the same");
  }
}

void switch_off_automatic_focus(ControlGuard& guard) {
  switch_off(guard, {V4L2_CID_FOCUS_AUTO, {0}},
             ", and nothing can be measured with a lens that moves by itself; close what else uses "
             "it, plug it out and in again, or measure with another camera");
}

}  // namespace fathom::v4l2
