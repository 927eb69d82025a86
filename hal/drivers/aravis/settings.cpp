// SPDX-License-Identifier: Apache-2.0
#include "hal/drivers/aravis/settings.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace fathom::aravis {
namespace {

constexpr int kLargestSide = 65'535;
constexpr double kFarthest = 1e9;
/// Of a liquid lens some ten; a geared focus needs more, and `fathom rigs check` says how much.
constexpr double kUsualSettle_ms = 100;

/// The place of the word among the words.
std::size_t choice(const RigSettings& settings, const char* key,
                   std::span<const std::string_view> words) {
  const std::string word = settings.choice(key, std::string(words[0]), words);
  return static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin());
}

CameraKeys camera_keys(const RigSettings& settings) {
  static constexpr std::string_view kUses[] = {"luma", "red", "green", "blue"};
  static constexpr std::string_view kTriggers[] = {"auto", "off", "software"};
  static constexpr std::string_view kStamps[] = {"end", "start"};
  static constexpr std::string_view kAutomatics[] = {"off", "leave"};
  std::vector<std::string_view> formats = {"auto"};
  for (const PixelFormat& format : pixel_formats()) formats.push_back(format.name);
  CameraKeys keys;
  keys.format = settings.choice("format", "auto", formats);
  if (keys.format == "auto") keys.format.clear();
  keys.bayer = static_cast<MosaicUse>(choice(settings, "bayer", kUses));
  keys.x = settings.integer_if_given("x", 0, kLargestSide);
  keys.y = settings.integer_if_given("y", 0, kLargestSide);
  keys.width = settings.integer_if_given("width", 1, kLargestSide);
  keys.height = settings.integer_if_given("height", 1, kLargestSide);
  keys.binning = settings.integer_if_given("binning", 1, kLargestSide);
  keys.exposure_ms = settings.number("exposure_ms", 0, 0.001, 1e6);
  keys.gain = settings.number_if_given("gain", -kFarthest, kFarthest);
  keys.fps = settings.number("fps", 0, 0.001, 1e5);
  keys.trigger = static_cast<Trigger>(choice(settings, "trigger", kTriggers));
  keys.stamps_start = choice(settings, "stamp", kStamps) == 1;
  keys.delay_frames = settings.number("delay_frames", keys.delay_frames, 0, 100);
  keys.buffers = static_cast<int>(settings.integer("buffers", keys.buffers, 2, 256));
  keys.packet_bytes = static_cast<int>(settings.integer("packet_size", 0, 576, 16'000));
  keys.leave_automatics = choice(settings, "automatics", kAutomatics) == 1;
  return keys;
}

LensKeys lens_keys(const RigSettings& settings) {
  LensKeys keys;
  keys.node = settings.text("lens", "");
  keys.lowest = settings.number_if_given("lowest", -kFarthest, kFarthest);
  keys.highest = settings.number_if_given("highest", -kFarthest, kFarthest);
  keys.step = settings.number("step", 1, 1e-9, kFarthest);
  if (!settings.has("step")) keys.step.reset();
  LensTraits usual;
  usual.settle_ms = kUsualSettle_ms;
  keys.traits = LensTraits::read(settings, usual);
  return keys;
}

}  // namespace

Settings Settings::read(const RigSettings& settings) {
  return {settings.text("camera", ""), aravis::camera_keys(settings), aravis::lens_keys(settings)};
}

}  // namespace fathom::aravis
