// SPDX-License-Identifier: Apache-2.0
#include "depth/halve.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "depth/parallel.hpp"

namespace fathom::depth {
namespace {

/// One row of a frame, which need not be aligned.
template <class Pixel>
void read_row(const Frame& frame, int y, std::vector<Pixel>& row) {
  std::memcpy(row.data(), frame.row(std::clamp(y, 0, frame.height_px() - 1)),
              row.size() * sizeof(Pixel));
}

/// kScale: levels of the result for each grey level.
template <class Pixel, std::uint32_t kScale>
void halve_rows(const Frame& frame, int first, int end, std::uint16_t* out) {
  constexpr std::uint32_t kDivisor = 64 / kScale, kHalf = kDivisor / 2;
  const int width = frame.width_px(), half = width / 2;
  std::vector<Pixel> rows[4];
  for (auto& row : rows) row.resize(width);
  std::vector<std::uint32_t> sums(width + 2);
  std::uint32_t* const sum = sums.data() + 1;
  for (int y = first; y < end; ++y) {
    for (int i = 0; i < 4; ++i) read_row(frame, 2 * y - 1 + i, rows[i]);
    const Pixel *a = rows[0].data(), *b = rows[1].data(), *c = rows[2].data(), *d = rows[3].data();
    for (int x = 0; x < width; ++x) sum[x] = a[x] + 3u * (b[x] + c[x]) + d[x];
    sum[-1] = sum[0];
    sum[width] = sum[width - 1];
    std::uint16_t* const line = out + static_cast<std::size_t>(y) * half;
    for (int x = 0; x < half; ++x) {
      const std::uint32_t all = sum[2 * x - 1] + 3 * (sum[2 * x] + sum[2 * x + 1]) + sum[2 * x + 2];
      line[x] = static_cast<std::uint16_t>((all + kHalf) / kDivisor);
    }
  }
}

}  // namespace

Frame halve(const Frame& frame, std::vector<std::uint16_t>& pixels, int threads) {
  const int width = frame.width_px() / 2, height = frame.height_px() / 2;
  pixels.resize(static_cast<std::size_t>(width) * height);
  constexpr std::size_t kRows = 64;
  share_out(height, kRows, threads, [&](std::size_t first, std::size_t end) {
    const auto rows = frame.depth() == Depth::bits8 ? halve_rows<std::uint8_t, kFineness>
                                                    : halve_rows<std::uint16_t, 1>;
    rows(frame, static_cast<int>(first), static_cast<int>(end), pixels.data());
  });
  return Frame::view(pixels.data(), width, height, Depth::bits16, width * sizeof(std::uint16_t));
}

}  // namespace fathom::depth
