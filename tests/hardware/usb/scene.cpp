// SPDX-License-Identifier: Apache-2.0
#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <stdexcept>

namespace fathom::usb {

namespace {

std::uint16_t light(double part) {
  return static_cast<std::uint16_t>(std::clamp(part, 0.0, 1.0) * 65535);
}

template <typename Value>
Picture drawn(int width_px, int height_px, const Value& value) {
  Picture picture{width_px, height_px, {}};
  picture.pixels.reserve(static_cast<std::size_t>(width_px * height_px));
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) picture.pixels.push_back(light(value(x, y)));
  }
  return picture;
}

// Noise of one scale: mean 0, variance 1.
std::vector<float> octave(std::mt19937& random, int width_px, int height_px, double sigma_px) {
  Picture noise{width_px, height_px, {}};
  noise.pixels.resize(static_cast<std::size_t>(width_px * height_px));
  for (std::uint16_t& pixel : noise.pixels) pixel = static_cast<std::uint16_t>(random() >> 16);
  if (sigma_px > 0) noise = blurred(noise, sigma_px);
  double sum = 0, squares = 0;
  for (const std::uint16_t pixel : noise.pixels) sum += pixel, squares += double{1} * pixel * pixel;
  const auto count = static_cast<double>(noise.pixels.size());
  const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
  std::vector<float> values;
  values.reserve(noise.pixels.size());
  for (const std::uint16_t pixel : noise.pixels) {
    values.push_back(static_cast<float>((pixel - mean) / deviation));
  }
  return values;
}

// Detail on every scale, so that the picture gets sharper all the way from any blur to none.
Picture texture(std::uint32_t seed, int width_px, int height_px) {
  std::mt19937 random(seed);
  std::vector<float> sum(static_cast<std::size_t>(width_px * height_px));
  for (const double sigma_px : {0.0, 1.0, 2.0, 4.0, 8.0, 16.0}) {
    const std::vector<float> values = octave(random, width_px, height_px, sigma_px);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += values[i];
  }
  // Half of full light on average; six octaves of variance 1 are within it but for rare pixels.
  return drawn(width_px, height_px, [&](int x, int y) {
    return 0.45 + 0.055 * sum[static_cast<std::size_t>(y * width_px + x)];
  });
}

Picture pgm(const std::string& path, int width_px, int height_px) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int width = 0, height = 0, most = 0;
  if (!(file >> magic >> width >> height >> most) || magic != "P5" || most != 255 || width < 1 ||
      height < 1 || width > 10000 || height > 10000) {
    throw std::runtime_error("no scene \"" + path + "\": texture, bars, star or an 8-bit P5 PGM");
  }
  file.get();
  std::string bytes(static_cast<std::size_t>(width * height), '\0');
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw std::runtime_error(path + " is cut short");
  }
  return drawn(width_px, height_px, [&](int x, int y) {
    const auto at = static_cast<std::size_t>((y % height) * width + x % width);
    return static_cast<unsigned char>(bytes[at]) / 255.0;
  });
}

}  // namespace

Picture make_scene(const std::string& kind, std::uint32_t seed, int width_px, int height_px) {
  if (kind == "texture") return texture(seed, width_px, height_px);
  if (kind == "bars") {
    return drawn(width_px, height_px, [](int x, int) { return x / 16 % 2 == 0 ? 0.2 : 0.75; });
  }
  if (kind == "star") {
    return drawn(width_px, height_px, [&](int x, int y) {
      const double angle = std::atan2(y - height_px / 2.0, x - width_px / 2.0);
      return 0.45 + 0.3 * std::sin(36 * angle);
    });
  }
  return pgm(kind, width_px, height_px);
}

}  // namespace fathom::usb
