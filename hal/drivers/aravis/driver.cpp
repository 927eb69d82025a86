// SPDX-License-Identifier: Apache-2.0
// GigE Vision and USB3 Vision cameras, with the lenses that they move, by the library Aravis.
#include <fmt/format.h>

#include "engine/error.hpp"
#include "hal/drivers/aravis/camera.hpp"
#include "hal/drivers/aravis/lens.hpp"
#include "hal/drivers/aravis/usb_access.hpp"
#include "hal/rig_driver.hpp"

namespace fathom {
namespace aravis {
namespace {

std::string text_or(const char* text, const char* fallback) {
  return text == nullptr || *text == 0 ? fallback : text;
}

/// An ID that a rig text would take for a key or for two is named by its address.
std::string rig_name(unsigned i) {
  const std::string id = text_or(api().arv_get_device_id(i), "");
  const bool is_plain = !id.empty() && id.find_first_of(",=") == std::string::npos;
  return is_plain ? id : text_or(api().arv_get_device_address(i), "?");
}

FoundHardware found_at(unsigned i) {
  FoundHardware found;
  found.text = "aravis:" + rig_name(i);
  found.description = fmt::format("{} {}, serial number {}, {} at {}; rigs check tells of lens=",
                                  text_or(api().arv_get_device_vendor(i), "?"),
                                  text_or(api().arv_get_device_model(i), "?"),
                                  text_or(api().arv_get_device_serial_nbr(i), "?"),
                                  text_or(api().arv_get_device_protocol(i), "?"),
                                  text_or(api().arv_get_device_address(i), "?"));
  found.has_camera = true;
  return found;
}

class AravisDriver final : public RigDriver {
 public:
  const char* name() const noexcept override { return "aravis"; }

  const char* summary() const noexcept override {
    return "GigE Vision and USB3 Vision cameras: aravis:ID (or serial number, address), "
           "exposure_ms=MS, gain=X, format=NAME, bayer=luma|red|green|blue, x=, y=, width=, "
           "height=, binning=N, fps=N, trigger=auto|off|software, stamp=end|start, "
           "packet_size=BYTES, buffers=N; of a lens that the camera moves: lens=FEATURE, lowest, "
           "highest, step, settle_ms, backlash";
  }

  const char* bare_key() const noexcept override { return "camera"; }
  bool has_lens_traits() const noexcept override { return true; }

  std::vector<FoundHardware> find() const override {
    std::vector<FoundHardware> found = unreadable_usb_cameras();
    try {
      api().arv_update_device_list();
    } catch (const Error&) {  // obstacle() says why
      return found;
    }
    for (unsigned i = 0; i < api().arv_get_n_devices(); ++i) found.push_back(found_at(i));
    return found;
  }

  std::string obstacle() const override {
    try {
      api();
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  }

  Hardware open(const RigSettings& rig, const OpenOptions& options) const override {
    const Settings settings = Settings::read(rig);
    rig.require_all_used();  // before anything is asked of a camera
    const bool has_lens = !settings.lens_keys.node.empty();
    if (!options.camera && !has_lens) return {};
    const auto device = Device::open(settings.camera);
    Hardware hardware;
    if (options.lens && has_lens)
      hardware.lens = open_lens(device, settings.lens_keys, options.stop_requests);
    if (options.camera)
      hardware.camera = open_camera(device, settings.camera_keys, options.stop_requests);
    if (options.lens && !has_lens) require_no_other_lens(rig, *device);
    return hardware;
  }

 private:
  /// One who wants the lens of the camera, and did not say which, is told.
  static void require_no_other_lens(const RigSettings& rig, const Device& device) {
    const std::string names = focus_features(device);
    if (names.empty()) return;
    throw Error(ErrorCode::unavailable, fmt::format("{}: {} moves a lens: write lens={}",
                                                    rig.where(), device.name(), names));
  }
};

}  // namespace
}  // namespace aravis

const RigDriver& aravis_driver() {
  static const aravis::AravisDriver driver;
  return driver;
}

}  // namespace fathom
