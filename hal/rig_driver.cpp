// SPDX-License-Identifier: Apache-2.0
#include "hal/rig_driver.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"
#include "hal/rig_text.hpp"

namespace fathom {
namespace {

Hardware open_part(RigPart part, const OpenOptions& options) {
  if (options.lens && part.driver->has_lens_traits()) {
    for (const auto& [key, value] : options.lens_overrides) part.settings.set(key, value);
  }
  Hardware hardware = part.driver->open(part.settings, options);
  part.settings.require_all_used();
  return hardware;
}

/// Each driver of a rig file with two tables opens its half alone.
Hardware open_halves(const RigPart& camera, const RigPart& lens, const OpenOptions& options) {
  OpenOptions half = options;
  Hardware hardware;
  if (options.camera) {
    half.lens = false;
    hardware.camera = open_part(camera, half).camera;
  }
  if (options.lens) {
    half.camera = false;
    half.lens = true;
    hardware.lens = open_part(lens, half).lens;
  }
  return hardware;  // no stage: it moves the target of one of the two, and nobody knows which
}

void require_there(bool wanted, bool there, std::string_view text, const char* what) {
  if (!wanted || there) return;
  throw Error(ErrorCode::unavailable,
              fmt::format("rig \"{}\" has no {}; put two drivers together in a rig file, with the "
                          "tables [camera] and [lens]",
                          text, what));
}

}  // namespace

Hardware open_hardware(std::string_view text, const OpenOptions& options) {
  const RigRequest request = parse_rig(text);
  Hardware hardware = request.lens ? open_halves(request.camera, *request.lens, options)
                                   : open_part(request.camera, options);
  require_there(options.camera, hardware.camera != nullptr, text, "camera");
  require_there(options.lens, hardware.lens != nullptr, text, "lens");
  return hardware;
}

const RigDriver& lens_driver_of(std::string_view text) {
  const RigRequest request = parse_rig(text);
  return *(request.lens ? *request.lens : request.camera).driver;
}

bool lens_has_key(std::string_view text, std::string_view key) {
  const RigRequest request = parse_rig(text);
  return (request.lens ? *request.lens : request.camera)
      .settings.values()
      .contains(std::string(key));
}

}  // namespace fathom
