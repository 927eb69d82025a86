// SPDX-License-Identifier: Apache-2.0
// How much of a window lies in each ring of spatial frequency.
#include <fathom/backends/backends.hpp>
#include <fathom/engine/scorer.hpp>

#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
  constexpr int kSide = 64;
  std::vector<std::uint8_t> stripes(kSide * kSide);  // Of 4 pixels: 0.25 cycles per pixel.
  for (int i = 0; i < kSide * kSide; ++i) stripes[i] = i % 4 < 2 ? 40 : 200;
  const auto frame = fathom::Frame::view(stripes.data(), kSide, kSide, fathom::Depth::bits8, kSide);

  const auto spec = fathom::MetricSpec::parse("fft:64:none:power:rings=8");
  fathom::Scorer scorer(fathom::select_device(fathom::all_backends(), "auto", spec, 1), spec,
                        fathom::Window{.x = 0, .y = 0, .n = kSide});

  std::vector<double> powers(scorer.outputs());  // 8 of the one window.
  scorer.score(frame, powers);
  for (std::size_t k = 0; k < powers.size(); ++k) {
    std::printf("up to %.4f cycles per pixel: %.4g\n", 0.5 * (k + 1) / powers.size(), powers[k]);
  }
}
