// SPDX-License-Identifier: Apache-2.0
// Scores a stream of frames: the camera fills one while the device works on those before it.
#include <fathom/backends/backends.hpp>
#include <fathom/engine/selection.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

constexpr int kWidth = 256, kHeight = 240, kFrames = 40;

struct Slot {
  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(kWidth * kHeight);
  fathom::Frame frame;
  std::vector<double> values;
  fathom::Plan::Ticket ticket;
};

// In place of a camera: stripes whose contrast is greatest in frame 25.
void grab(int number, std::vector<std::uint8_t>& pixels) {
  const int contrast = 100 - 2 * std::abs(number - 25);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = i % 8 < 4 ? 20 : 20 + contrast;
}

}  // namespace

int main() {
  const auto spec = fathom::MetricSpec::parse("walsh-sequency:64");
  const auto windows = fathom::window_grid(kWidth, kHeight, {0, 0, spec.n}, spec.n / 2);
  const auto selection =
      fathom::select_device(fathom::all_backends(), "auto", spec, windows.size());
  const auto plan = selection.device->plan(spec, windows.size());  // Made once, not for each frame.

  std::array<Slot, 3> ring;  // Two batches in flight, and the frame that is being taken.
  for (Slot& slot : ring) slot.values.resize(windows.size() * spec.outputs());

  int sharpest = 0;
  double best = 0;
  const auto finish = [&](int number) {
    const Slot& slot = ring[number % ring.size()];
    plan->wait(slot.ticket);  // Now the values are there, and the pixels may change.
    if (slot.values[0] > best) best = slot.values[0], sharpest = number;
  };

  const int in_flight = ring.size();
  for (int number = 0; number < kFrames; ++number) {
    Slot& slot = ring[number % ring.size()];
    if (number >= in_flight) finish(number - in_flight);
    grab(number, slot.pixels);
    slot.frame =
        fathom::Frame::view(slot.pixels.data(), kWidth, kHeight, fathom::Depth::bits8, kWidth);
    slot.ticket = plan->submit(slot.frame, windows, slot.values);
  }
  for (int number = kFrames - in_flight; number < kFrames; ++number) finish(number);
  std::printf("sharpest of %d frames: %d\n", kFrames, sharpest);
}
