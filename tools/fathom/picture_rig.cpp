// SPDX-License-Identifier: Apache-2.0
#include "tools/fathom/picture_rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/windowed_metric.hpp"
#include "tools/fathom/arguments.hpp"
#include "tools/fathom/console.hpp"

namespace fathom::cli {
namespace {

std::string metric_for(Camera& camera) {
  const CameraSettings picture = camera.settings();
  int side = kDefaultWindowSide;
  while (side > kSmallestWindow && side > std::min(picture.width_px, picture.height_px)) side /= 2;
  return fmt::format("fft:{}", side);
}

}  // namespace

Rig open_picture_rig(const std::string& rig, int average) {
  RigOptions options;
  options.rig = rig;
  options.shot.average = checked_average(average);
  options.shot.stop_requests = stop_requests;
  Hardware hardware = open_hardware(rig, {.stop_requests = stop_requests});
  options.metric = metric_for(*hardware.camera);
  return Rig(options, std::move(hardware));
}

}  // namespace fathom::cli
