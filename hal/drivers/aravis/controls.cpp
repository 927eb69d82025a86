// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/controls.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/error.hpp"

namespace fathom::aravis {
namespace {

constexpr double kUsPerMs = 1000;
/// What a camera rounds to the ticks of its timer is kept; more is told.
constexpr double kRounding = 0.01;

constexpr const char* kAutomatics[] = {"ExposureAuto", "GainAuto", "BalanceWhiteAuto",
                                       "BlackLevelAuto"};

std::vector<const PixelFormat*> offered_by(const Device& device) {
  unsigned count = 0;
  gint64* const codes = device.ask("ask for its pixel formats", [&](GError** error) {
    return api().arv_camera_dup_available_pixel_formats(device.camera(), &count, error);
  });
  std::vector<const PixelFormat*> offered;
  for (const PixelFormat& format : pixel_formats()) {
    if (std::find(codes, codes + count, static_cast<gint64>(format.code)) != codes + count)
      offered.push_back(&format);
  }
  (api().g_free)(codes);
  return offered;
}

std::string names_of(const std::vector<const PixelFormat*>& formats) {
  std::vector<std::string_view> names;
  for (const PixelFormat* format : formats) names.push_back(format->name);
  return names.empty() ? "none that is read" : fmt::format("{}", fmt::join(names, ", "));
}

/// The triggers of a camera: "FrameStart", ...; none where it cannot be triggered.
std::vector<std::string> triggers_of(const Device& device) {
  if (!device.has("TriggerMode")) return {};
  if (!device.has("TriggerSelector")) return {""};
  unsigned count = 0;
  const char** const names = device.ask("ask for its triggers", [&](GError** error) {
    return api().arv_camera_dup_available_triggers(device.camera(), &count, error);
  });
  std::vector<std::string> triggers(names, names + count);
  (api().g_free)(names);
  return triggers;
}

std::int64_t on_grid(const Range& range, double value) {
  const double inside = std::clamp(value, range.lowest, range.highest);
  const double steps = std::floor((inside - range.lowest) / range.step + 0.5);
  const double nearest = range.lowest + steps * range.step;
  return std::llround(nearest > range.highest ? nearest - range.step : nearest);
}

}  // namespace

Controls::Controls(std::shared_ptr<Device> device, const CameraKeys& keys)
    : device_(std::move(device)), use_(keys.bayer), restorer_(device_) {
  restorer_.set_text("AcquisitionMode", "Continuous");
  offered_ = offered_by(*device_);
  is_format_fixed_ = !keys.format.empty();
  remember_geometry();
  set_format(*choose_format(keys.format));
  set_geometry(keys);
  if (!keys.leave_automatics) {
    for (const char* const feature : kAutomatics) restorer_.set_text(feature, "Off");
  }
  set_light(keys);
  set_trigger(keys.trigger);
  learn();
}

const PixelFormat* Controls::choose_format(const std::string& name) const {
  if (offered_.empty()) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} has no grey or Bayer pixel format that is read", device_->name()));
  }
  if (name.empty()) {
    const auto code = device_->ask("read its pixel format", [&](GError** error) {
      return api().arv_camera_get_pixel_format(device_->camera(), error);
    });
    const PixelFormat* const found = find_pixel_format(code);
    return found != nullptr ? found : offered_.front();
  }
  for (const PixelFormat* format : offered_) {
    if (format->name == name) return format;
  }
  throw Error(ErrorCode::unsupported, fmt::format("{} has no format={}; it has {}", device_->name(),
                                                  name, names_of(offered_)));
}

const PixelFormat* Controls::format_of_depth(Depth depth) const {
  if (is_format_fixed_ || format_->depth() == depth) return format_;
  for (const PixelFormat* format : offered_) {
    if (format->depth() == depth && format->is_mosaic() == format_->is_mosaic()) return format;
  }
  return format_;
}

void Controls::set_format(const PixelFormat& format) {
  device_->ask(fmt::format("set its format to {}", format.name), [&](GError** error) {
    api().arv_camera_set_pixel_format(device_->camera(), format.code, error);
  });
  format_ = &format;
}

/// Offsets first and last: a picture must fit on the sensor at each moment.
void Controls::remember_geometry() {
  const auto format = device_->ask("read its pixel format", [&](GError** error) {
    return api().arv_camera_get_pixel_format(device_->camera(), error);
  });
  std::vector<std::pair<std::string, std::int64_t>> found;
  for (const char* const feature :
       {"BinningHorizontal", "BinningVertical", "Width", "Height", "OffsetX", "OffsetY"}) {
    if (device_->has(feature)) found.emplace_back(feature, device_->integer(feature));
  }
  restorer_.at_end([this, found, format] {
    for (const char* const offset : {"OffsetX", "OffsetY"}) {
      if (device_->has(offset)) device_->set_integer(offset, 0);
    }
    for (const auto& [feature, value] : found) device_->set_integer(feature, value);
    device_->ask("set its format back", [&](GError** error) {
      api().arv_camera_set_pixel_format(device_->camera(), format, error);
    });
  });
}

void Controls::set_geometry(const CameraKeys& keys) {
  if (keys.binning) {
    for (const char* const feature : {"BinningHorizontal", "BinningVertical"}) {
      if (!device_->has(feature)) {
        throw Error(ErrorCode::unsupported,
                    fmt::format("{} cannot bin; leave binning out", device_->name()));
      }
      device_->set_integer(feature, *keys.binning);
    }
  }
  set_side("Width", "OffsetX", keys.x, keys.width);
  set_side("Height", "OffsetY", keys.y, keys.height);
}

void Controls::set_side(const char* side, const char* offset, std::optional<int> start,
                        std::optional<int> length) {
  if (!start && !length) return;
  const auto set = [&](const char* feature, int value) {
    const Range range = device_->integer_range(feature);
    if (on_grid(range, value) != value) {
      throw Error(
          ErrorCode::unsupported,
          fmt::format("{}: {} cannot be {}; it goes from {} to {} in steps of {}", device_->name(),
                      feature, value, range.lowest, range.highest, range.step));
    }
    device_->set_integer(feature, value);
  };
  const bool has_offset = device_->has(offset);
  if (start && !has_offset) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} has no {}; leave x and y out", device_->name(), offset));
  }
  const auto old_start = has_offset ? static_cast<int>(device_->integer(offset)) : 0;
  if (has_offset) device_->set_integer(offset, 0);
  if (length) set(side, *length);
  if (has_offset && start.value_or(old_start) != 0) set(offset, start.value_or(old_start));
}

void Controls::set_light(const CameraKeys& keys) {
  ArvCamera* const camera = device_->camera();
  has_exposure_ = device_->ask("look for its exposure", [&](GError** error) {
    return api().arv_camera_is_exposure_time_available(camera, error);
  }) != 0;
  if (keys.exposure_ms > 0 && !has_exposure_) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} has no exposure time; leave exposure_ms out", device_->name()));
  }
  if (has_exposure_) {
    const double found = device_->ask("read its exposure", [&](GError** error) {
      return api().arv_camera_get_exposure_time(camera, error);
    });
    restorer_.at_end([this, found] { set_exposure(found / kUsPerMs); });
    exposure_us_ = found;
    if (keys.exposure_ms > 0) set_exposure(keys.exposure_ms);
  }
  if (keys.gain) set_gain(*keys.gain);
  if (keys.fps > 0) set_rate(keys.fps);
}

void Controls::set_exposure(double exposure_ms) {
  const double wished_us = exposure_ms * kUsPerMs;
  ArvCamera* const camera = device_->camera();
  const Range range_us = exposure_us();
  const bool is_within = wished_us >= range_us.lowest && wished_us <= range_us.highest;
  if (is_within && wished_us != exposure_us_) {
    device_->ask(fmt::format("set its exposure to {:g} ms", exposure_ms), [&](GError** error) {
      api().arv_camera_set_exposure_time(camera, wished_us, error);
    });
  }
  exposure_us_ = device_->ask("read its exposure", [&](GError** error) {
    return api().arv_camera_get_exposure_time(camera, error);
  });
  if (std::abs(exposure_us_ - wished_us) <= std::max(1.0, kRounding * wished_us)) return;
  const double nearest_us =
      is_within ? exposure_us_ : std::clamp(wished_us, range_us.lowest, range_us.highest);
  throw Error(ErrorCode::unsupported,
              fmt::format("{} cannot keep exposure_ms={:g}; the nearest is {:g} (of {:g} to {:g})",
                          device_->name(), exposure_ms, nearest_us / kUsPerMs,
                          range_us.lowest / kUsPerMs, range_us.highest / kUsPerMs));
}

Range Controls::exposure_us() const {
  Range range;
  device_->ask("read the range of its exposure", [&](GError** error) {
    api().arv_camera_get_exposure_time_bounds(device_->camera(), &range.lowest, &range.highest,
                                              error);
  });
  return range;
}

void Controls::set_gain(double gain) {
  ArvCamera* const camera = device_->camera();
  const bool has_gain = device_->ask("look for its gain", [&](GError** error) {
    return api().arv_camera_is_gain_available(camera, error);
  }) != 0;
  if (!has_gain) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} has no gain; leave gain out", device_->name()));
  }
  double lowest = 0, highest = 0;
  device_->ask("read the range of its gain", [&](GError** error) {
    api().arv_camera_get_gain_bounds(camera, &lowest, &highest, error);
  });
  if (!(gain >= lowest && gain <= highest)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} cannot keep gain={:g}; it goes from {:g} to "
                            "{:g}",
                            device_->name(), gain, lowest, highest));
  }
  const auto set = [this, camera](double value) {
    device_->ask(fmt::format("set its gain to {:g}", value),
                 [&](GError** error) { api().arv_camera_set_gain(camera, value, error); });
  };
  const double found = device_->ask(
      "read its gain", [&](GError** error) { return api().arv_camera_get_gain(camera, error); });
  restorer_.at_end([set, found] { set(found); });
  set(gain);
}

void Controls::set_rate(double fps) {
  ArvCamera* const camera = device_->camera();
  const auto set = [this, camera](double value) {
    device_->ask(fmt::format("set its frame rate to {:g}", value),
                 [&](GError** error) { api().arv_camera_set_frame_rate(camera, value, error); });
  };
  const auto read = [&] {
    return device_->ask("read its frame rate", [&](GError** error) {
      return api().arv_camera_get_frame_rate(camera, error);
    });
  };
  const double found = read();
  restorer_.at_end([set, found] { set(found); });
  set(fps);
  const double got = read();
  if (std::abs(got - fps) <= kRounding * fps) return;
  throw Error(ErrorCode::unsupported, fmt::format("{} cannot keep fps={:g}; the nearest is {:g}",
                                                  device_->name(), fps, got));
}

/// Whatever else would hold frames back is switched off.
void Controls::set_trigger(Trigger trigger) {
  for (const std::string& name : triggers_of(*device_)) {
    if (!name.empty()) restorer_.set_text("TriggerSelector", name);
    restorer_.set_text("TriggerMode", "Off");
  }
  if (trigger == Trigger::none) return;
  is_triggered_ = set_software_trigger();
  if (is_triggered_ || trigger == Trigger::automatic) return;
  throw Error(ErrorCode::unsupported,
              fmt::format("{} cannot be triggered by software; trigger=off lets its frames come by "
                          "themselves",
                          device_->name()));
}

bool Controls::set_software_trigger() {
  const bool can = device_->ask("look for its software trigger", [&](GError** error) {
    return api().arv_camera_is_software_trigger_supported(device_->camera(), error);
  }) != 0;
  if (!can || !device_->has_choice("TriggerSource", "Software")) return false;
  restorer_.set_text("TriggerSelector", "FrameStart");
  restorer_.set_text("TriggerSource", "Software");
  restorer_.set_text("TriggerMode", "On");
  return true;
}

void Controls::learn() {
  settings_ = {side_of(static_cast<int>(device_->integer("Width")), *format_, use_),
               side_of(static_cast<int>(device_->integer("Height")), *format_, use_),
               format_->depth(), exposure_us_ / kUsPerMs};
  const bool has_rate = device_->ask("look for its frame rate", [&](GError** error) {
    return api().arv_camera_is_frame_rate_available(device_->camera(), error);
  }) != 0;
  if (!has_rate) return;
  const double fps = device_->ask("read its frame rate", [&](GError** error) {
    return api().arv_camera_get_frame_rate(device_->camera(), error);
  });
  interval_ns_ = fps > 0 ? std::llround(1e9 / fps) : 0;
}

/// In pixels of the frame. The offset stays where it is, which leaves so much less.
int Controls::nearest_side(const char* feature, int wished_px) const {
  const int part = side_of(2, *format_, use_) == 2 ? 1 : 2;
  const auto now = static_cast<int>(device_->integer(feature));
  if (wished_px == now / part) return wished_px;
  const Range range = device_->integer_range(feature);
  return static_cast<int>(on_grid(range, 1.0 * wished_px * part)) / part;
}

CameraSettings Controls::nearest(const CameraSettings& wished) const {
  CameraSettings possible = settings_;
  possible.width_px = nearest_side("Width", wished.width_px);
  possible.height_px = nearest_side("Height", wished.height_px);
  possible.depth = format_of_depth(wished.depth)->depth();
  if (!has_exposure_ || wished.exposure_ms == settings_.exposure_ms) return possible;
  const Range range_us = exposure_us();
  const double rounded_us = std::round(wished.exposure_ms * kUsPerMs);
  possible.exposure_ms = std::clamp(rounded_us, range_us.lowest, range_us.highest) / kUsPerMs;
  return possible;
}

void Controls::apply(const CameraSettings& settings) {
  const int part = side_of(2, *format_, use_) == 2 ? 1 : 2;
  const auto set_side_of = [&](const char* feature, int wished_px, int now_px) {
    if (wished_px != now_px) device_->set_integer(feature, wished_px * part);
  };
  set_format(*format_of_depth(settings.depth));
  set_side_of("Width", settings.width_px, settings_.width_px);
  set_side_of("Height", settings.height_px, settings_.height_px);
  if (has_exposure_) set_exposure(settings.exposure_ms);
  learn();
}

}  // namespace fathom::aravis
