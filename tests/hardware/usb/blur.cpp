// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

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

// Rows with what lies outside beside them: as at the border.
class PaddedRow {
 public:
  PaddedRow(int size, int radius)
      : size_(size), margin_(radius + 1), pixels_(static_cast<std::size_t>(size + 2 * margin_)) {}
  std::uint16_t* begin() { return pixels_.data() + margin_; }
  void pad() {
    std::fill_n(pixels_.data(), margin_, *begin());
    std::fill_n(begin() + size_, margin_, begin()[size_ - 1]);
  }

 private:
  int size_, margin_;
  std::vector<std::uint16_t> pixels_;
};

void blur_row(const Box& box, PaddedRow& row, std::uint16_t* to, int size) {
  row.pad();
  const std::uint16_t* left = row.begin() - box.radius - 1;  // Just outside of the box.
  const std::uint16_t* right = row.begin() + box.radius + 1;
  std::int64_t sum = std::accumulate(left + 1, right, std::int64_t{0});
  for (int x = 0; x < size; ++x, ++left, ++right) {
    const std::int64_t value = sum * box.inner + (*left + *right) * box.edge + (1 << 23);
    to[x] = static_cast<std::uint16_t>(std::min<std::int64_t>(value >> 24, 65535));
    sum += *right - left[1];
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
  const int width = picture.width_px;
  PaddedRow one(width, box.radius), two(width, box.radius);
  for (int y = 0; y < picture.height_px; ++y) {
    std::uint16_t* row = picture.pixels.data() + static_cast<std::ptrdiff_t>(y) * width;
    std::copy_n(row, width, one.begin());
    blur_row(box, one, two.begin(), width);
    blur_row(box, two, one.begin(), width);
    blur_row(box, one, row, width);
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

const Picture& BlurredScene::at(int defocus) {
  const auto found = made_.find(defocus);
  if (found != made_.end()) return found->second;
  constexpr std::size_t most_bytes = 64 << 20;  // The guest has little memory.
  const std::size_t bytes = sharp_.pixels.size() * sizeof(std::uint16_t);
  if ((made_.size() + 1) * bytes > most_bytes) made_.clear();
  return made_[defocus] = blurred(sharp_, std::hypot(sharp_px_, defocus / 64.0));
}

}  // namespace fathom::usb
