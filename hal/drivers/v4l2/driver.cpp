// SPDX-License-Identifier: Apache-2.0
// Cameras and motorised lenses of Linux's own interface: webcams, capture cards, sensor boards.
#include "hal/drivers/v4l2/driver.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"
#include "hal/drivers/v4l2/camera.hpp"
#include "hal/drivers/v4l2/find.hpp"
#include "hal/drivers/v4l2/lens.hpp"

namespace fathom {
namespace v4l2 {

Hardware open(System& system, const RigSettings& settings, const OpenOptions& options) {
  const std::string path = settings.text("device", "");
  const std::string lens_path = settings.text("lens", "");
  const CameraKeys camera_keys = CameraKeys::read(settings);
  const LensKeys lens_keys = LensKeys::read(settings);
  if (path.empty() && (lens_path.empty() || options.camera)) {
    throw Error(
        ErrorCode::bad_argument,
        fmt::format("{}: which device? Write v4l2:/dev/video0; `fathom rigs list` shows what "
                    "is plugged in",
                    settings.where()));
  }
  Hardware hardware;
  if (options.camera) {
    hardware.camera = open_camera(Device::open(system, path), camera_keys, options.stop_requests);
  }
  if (options.lens) {
    const auto device = Device::open(system, lens_path.empty() ? path : lens_path);
    hardware.lens = open_lens(device, lens_keys, options.stop_requests);
    if (hardware.lens == nullptr && !lens_path.empty()) {
      throw Error(ErrorCode::unsupported,
                  fmt::format("{} has no focus that can be set", lens_path));
    }
  }
  return hardware;
}

namespace {

class V4l2Driver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "v4l2"; }

  const char* summary() const noexcept override {
    return "webcams and other V4L2 cameras, with their motorised focus: v4l2:/dev/video0; keys "
           "width, height, format, fps, exposure_ms, gain, settle_ms, lens=/dev/v4l-subdevN";
  }

  const char* bare_key() const noexcept override { return "device"; }

  std::span<const std::string_view> path_keys() const noexcept override {
    static constexpr std::string_view kKeys[] = {"device", "lens"};
    return kKeys;
  }

  bool has_lens_traits() const noexcept override { return true; }

  std::vector<FoundHardware> find() const override { return find_hardware(real_system()); }

  Hardware open(const RigSettings& settings, const OpenOptions& options) const override {
    return v4l2::open(real_system(), settings, options);
  }
};

}  // namespace
}  // namespace v4l2

const RigDriver& v4l2_driver() {
  static const v4l2::V4l2Driver driver;
  return driver;
}

}  // namespace fathom
