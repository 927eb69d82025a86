// SPDX-License-Identifier: Apache-2.0
// What of a camera is set for measuring: picture, light, trigger. All of it is put back at the end.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "hal/camera.hpp"
#include "hal/drivers/aravis/device.hpp"
#include "hal/drivers/aravis/settings.hpp"

namespace fathom::aravis {

class Controls {
 public:
  /// Throws as RigDriver::open.
  Controls(std::shared_ptr<Device> device, const CameraKeys& keys);

  /// Of the frames that it gives.
  const CameraSettings& settings() const { return settings_; }
  const PixelFormat& format() const { return *format_; }
  bool is_triggered() const { return is_triggered_; }
  /// From frame to frame as the camera says; 0 where it does not.
  std::int64_t interval_ns() const { return interval_ns_; }

  /// The nearest to a wish that has a meaning. Exposures are whole microseconds.
  CameraSettings nearest(const CameraSettings& wished) const;
  /// What nearest() gave. While no stream runs. Throws as Device::ask, Error(unsupported) if the camera
  /// makes something else of it.
  void apply(const CameraSettings& settings);

 private:
  const PixelFormat* choose_format(const std::string& name) const;
  const PixelFormat* format_of_depth(Depth depth) const;
  void set_format(const PixelFormat& format);
  void set_geometry(const CameraKeys& keys);
  void set_side(const char* side, const char* offset, std::optional<int> start,
                std::optional<int> length);
  void remember_geometry();
  void set_light(const CameraKeys& keys);
  void set_exposure(double exposure_ms);
  Range exposure_us() const;
  void set_gain(double gain);
  void set_rate(double fps);
  void set_trigger(Trigger trigger);
  bool set_software_trigger();
  void learn();
  int nearest_side(const char* feature, int wished_px) const;

  std::shared_ptr<Device> device_;
  MosaicUse use_;
  std::vector<const PixelFormat*> offered_;  ///< Best first.
  const PixelFormat* format_ = nullptr;
  CameraSettings settings_;
  double exposure_us_ = 0;
  std::int64_t interval_ns_ = 0;
  bool has_exposure_ = false;
  bool is_format_fixed_ = false;
  bool is_triggered_ = false;
  FeatureRestorer restorer_;  ///< The first to go: it still needs the others.
};

}  // namespace fathom::aravis
