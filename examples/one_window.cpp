// SPDX-License-Identifier: Apache-2.0
// The focus quality of one window of a picture that lies in memory.
#include <fathom/backends/backends.hpp>
#include <fathom/engine/scorer.hpp>

#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
  constexpr int kWidth = 256, kHeight = 240;
  std::vector<std::uint8_t> pixels(kWidth * kHeight);  // Your grey picture; here stripes.
  for (int i = 0; i < kWidth * kHeight; ++i) pixels[i] = i % 8 < 4 ? 40 : 200;

  const auto spec = fathom::MetricSpec::parse("fft:64:hann");
  const fathom::Window window{.x = 96, .y = 88, .n = 64};
  fathom::Scorer scorer(fathom::select_device(fathom::all_backends(), "auto", spec, 1), spec,
                        window);

  // The frame only looks at the pixels. The last argument is the distance between two rows, bytes.
  const auto frame =
      fathom::Frame::view(pixels.data(), kWidth, kHeight, fathom::Depth::bits8, kWidth);
  std::printf("%s: focus quality %.6g\n", scorer.spec().text().c_str(), scorer.score(frame));
}
