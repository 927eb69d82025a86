// SPDX-License-Identifier: Apache-2.0
#include "hal/rig_driver.hpp"

#include <fmt/format.h>

#include "engine/error.hpp"
#include "engine/file.hpp"
#include "hal/rig_text.hpp"

namespace fathom {
namespace {

constexpr std::uintmax_t kLargestRigFile = 1 << 20;

bool names_driver(std::string_view name) {
  for (const RigDriver* driver : all_rig_drivers()) {
    if (name == driver->name()) return true;
  }
  return false;
}

RigRequest parse_rig(std::string_view text) {
  // A driver's own name goes first: "replay:stack.toml" is no rig file.
  if (text.ends_with(".toml") && !names_driver(text.substr(0, text.find(':')))) {
    return parse_rig_file(read_file(text, kLargestRigFile), text);
  }
  return {parse_rig_options(text), std::nullopt};
}

Hardware open_part(const RigPart& part) {
  Hardware hardware = part.driver->open(part.settings);
  part.settings.require_all_used();
  return hardware;
}

}  // namespace

Hardware open_hardware(std::string_view text) {
  const RigRequest request = parse_rig(text);
  Hardware hardware = open_part(request.camera);
  if (request.lens) {
    hardware.lens = open_part(*request.lens).lens;
    hardware.stage = nullptr;  // it moves the target of one of the two, and nobody knows which
  }
  if (hardware.camera == nullptr || hardware.lens == nullptr) {
    throw Error(ErrorCode::unavailable,
                fmt::format("rig \"{}\" has no {}; put two drivers together in a rig file", text,
                            hardware.camera == nullptr ? "camera" : "lens"));
  }
  return hardware;
}

}  // namespace fathom
