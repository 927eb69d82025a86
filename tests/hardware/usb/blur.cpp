// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "scene.hpp"

namespace fathom::usb {

namespace {

// A box of 2 radius + 1 pixels with a fraction of the next on either side, so that its width is
// continuous (Gwosdek et al., Theoretical foundations of Gaussian convolution by extended box
// filtering, 2011). Weights are in 2^-24.
struct Box {
  int radius = 0;
  std::int64_t inner = 0, edge = 0;
};

Box box_of_variance(double variance) {
  const int radius = static_cast<int>((std::sqrt(1 + 12 * variance) - 1) / 2);
  const double width = 2.0 * radius + 1, next = radius + 1.0;
  const double fraction = width * (radius * next - 3 * variance) / (6 * (variance - next * next));
  const double whole = width + 2 * fraction;
  const auto fixed = [&](double weight) { return std::llround(weight / whole * (1 << 24)); };
  return {radius, fixed(1), fixed(fraction)};
}

void blur_row(const Box& box, const std::uint16_t* from, std::uint16_t* to, int size) {
  // What lies outside is as at the border.
  const auto at = [&](int x) { return std::int64_t{from[std::clamp(x, 0, size - 1)]}; };
  std::int64_t sum = 0;
  for (int x = -box.radius; x <= box.radius; ++x) sum += at(x);
  for (int x = 0; x < size; ++x) {
    const std::int64_t beside = at(x - box.radius - 1) + at(x + box.radius + 1);
    const std::int64_t value = (sum * box.inner + beside * box.edge + (1 << 23)) >> 24;
    to[x] = static_cast<std::uint16_t>(std::min<std::int64_t>(value, 65535));
    sum += at(x + box.radius + 1) - at(x - box.radius);
  }
}

Picture transposed(const Picture& picture) {
  Picture result{picture.height_px, picture.width_px, {}};
  result.pixels.resize(picture.pixels.size());
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      result.pixels[static_cast<std::size_t>(x * picture.height_px + y)] =
          picture.pixels[static_cast<std::size_t>(y * picture.width_px + x)];
    }
  }
  return result;
}

void blur_rows(Picture& picture, const Box& box) {
  const auto width = static_cast<std::size_t>(picture.width_px);
  std::vector<std::uint16_t> one(width), two(width);
  for (int y = 0; y < picture.height_px; ++y) {
    std::uint16_t* row = picture.pixels.data() + static_cast<std::size_t>(y) * width;
    blur_row(box, row, one.data(), picture.width_px);
    blur_row(box, one.data(), two.data(), picture.width_px);
    blur_row(box, two.data(), row, picture.width_px);
  }
}

}  // namespace

Picture blurred(const Picture& picture, double sigma_px) {
  const Box box = box_of_variance(sigma_px * sigma_px / 3);
  Picture result = transposed(picture);
  blur_rows(result, box);
  result = transposed(result);
  blur_rows(result, box);
  return result;
}

int BlurredScene::level(double sigma_px) { return static_cast<int>(std::lround(sigma_px * 16)); }

const Picture& BlurredScene::at(double sigma_px) {
  const int wanted = level(sigma_px);
  const auto found = made_.find(wanted);
  if (found != made_.end()) return found->second;
  constexpr std::size_t most_bytes = 64 << 20;  // The guest has little memory.
  const std::size_t bytes = sharp_.pixels.size() * sizeof(std::uint16_t);
  if ((made_.size() + 1) * bytes > most_bytes) made_.clear();
  return made_[wanted] = blurred(sharp_, wanted / 16.0);
}

}  // namespace fathom::usb
