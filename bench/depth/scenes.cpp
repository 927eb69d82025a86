// SPDX-License-Identifier: Apache-2.0
#include "bench/depth/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace fathom::scenes {
namespace {

struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;

  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
  float* row(int y) { return values.data() + static_cast<std::size_t>(y) * width; }
  const float* row(int y) const { return values.data() + static_cast<std::size_t>(y) * width; }
};

int wrapped(int i, int n) { return ((i % n) + n) % n; }

/// The picture is continued by itself, to all sides.
Plane gaussian(const Plane& in, double sigma) {
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  std::vector<float> weights;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(static_cast<float>(std::exp(-i * i / (2 * sigma * sigma))));
    sum += weights.back();
  }
  for (float& weight : weights) weight /= static_cast<float>(sum);
  Plane across(in.width, in.height), out(in.width, in.height);
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x) {
      float value = 0;
      for (int i = -reach; i <= reach; ++i) {
        value += weights[i + reach] * in.row(y)[wrapped(x + i, in.width)];
      }
      across.row(y)[x] = value;
    }
  }
  for (int y = 0; y < in.height; ++y) {
    for (int i = -reach; i <= reach; ++i) {
      const float* const from = across.row(wrapped(y + i, in.height));
      for (int x = 0; x < in.width; ++x) out.row(y)[x] += weights[i + reach] * from[x];
    }
  }
  return out;
}

/// A disc, by how much of it each pixel holds, counted on a grid of 8 x 8 points a pixel.
struct Disc {
  explicit Disc(double diameter) {
    constexpr int kPoints = 8;
    const double radius = diameter / 2;
    reach = static_cast<int>(std::ceil(radius)) + 1;
    parts.resize(static_cast<std::size_t>(side()) * side());
    float all = 0;
    for (int j = -reach * kPoints; j <= reach * kPoints; ++j) {
      for (int i = -reach * kPoints; i <= reach * kPoints; ++i) {
        const double x = static_cast<double>(i) / kPoints, y = static_cast<double>(j) / kPoints;
        if (std::hypot(x, y) > radius) continue;
        const int column = static_cast<int>(std::nearbyint(x)) + reach;
        const int row = static_cast<int>(std::nearbyint(y)) + reach;
        parts[static_cast<std::size_t>(row) * side() + column] += 1;
        ++all;
      }
    }
    for (float& part : parts) part /= all;
  }
  int side() const { return 2 * reach + 1; }

  int reach = 0;
  std::vector<float> parts;  ///< [row][column]
};

Plane blurred_by(const Disc& disc, const Plane& in) {
  Plane out(in.width, in.height);
  std::vector<float> around(in.width + 2 * disc.reach);
  for (int from = 0; from < in.height; ++from) {
    for (int x = -disc.reach; x < in.width + disc.reach; ++x) {
      around[x + disc.reach] = in.row(from)[wrapped(x, in.width)];
    }
    for (int j = 0; j < disc.side(); ++j) {
      float* const to = out.row(wrapped(from + j - disc.reach, in.height));
      for (int i = 0; i < disc.side(); ++i) {
        const float part = disc.parts[static_cast<std::size_t>(j) * disc.side() + i];
        if (part == 0) continue;
        for (int x = 0; x < in.width; ++x) to[x] += part * around[x + i];
      }
    }
  }
  return out;
}

void standardise(Plane& plane) {
  double mean = 0, square = 0;
  for (const float value : plane.values) mean += value;
  mean /= static_cast<double>(plane.values.size());
  for (const float value : plane.values) square += (value - mean) * (value - mean);
  const double deviation = std::sqrt(square / static_cast<double>(plane.values.size()));
  for (float& value : plane.values) value = static_cast<float>((value - mean) / deviation);
}

Plane white(const Options& options, std::mt19937& random) {
  Plane plane(options.width_px, options.height_px);
  std::normal_distribution<float> normal;
  for (float& value : plane.values) value = normal(random);
  return plane;
}

/// Octaves of equal power: noise as coarse as 1, 2, 4, ... 64 px.
Plane pink(const Options& options, std::mt19937& random) {
  Plane sum(options.width_px, options.height_px);
  for (double sigma = 0.5; sigma <= 32; sigma *= 2) {
    Plane octave = gaussian(white(options, random), sigma);
    standardise(octave);
    for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += octave.values[i];
  }
  return sum;
}

Plane specks(const Options& options, std::mt19937& random) {
  Plane plane(options.width_px, options.height_px);
  std::uniform_int_distribution<std::size_t> place(0, plane.values.size() - 1);
  for (std::size_t i = 0; i < plane.values.size() / 160; ++i) {
    const std::size_t at = place(random);
    plane.values[at] = random() % 2 == 0 ? -1.0f : 1.0f;
  }
  return gaussian(plane, 0.9);
}

Plane texture_of(Texture texture, const Options& options, std::mt19937& random) {
  constexpr float kMean = 110, kContrast = 32, kFaint = 3, kLeast = 4, kMost = 250;
  Plane plane = [&] {
    switch (texture) {
      case Texture::pink:
      case Texture::faint:
        return pink(options, random);
      case Texture::white:
        return gaussian(white(options, random), 0.7);
      case Texture::sparse:
        return specks(options, random);
    }
    return Plane(1, 1);  // no such texture
  }();
  standardise(plane);
  const float contrast = texture == Texture::faint ? kFaint : kContrast;
  for (float& value : plane.values) value = std::clamp(kMean + contrast * value, kLeast, kMost);
  return plane;
}

/// The texture at many diameters of blur, closer where little blurs much; between them it is
/// interpolated.
class Blurred {
 public:
  Blurred(const Plane& texture, double most_px) {
    constexpr double kLens = 0.45;
    for (int i = 0; i < 2 || diameter(i - 2) < most_px; ++i) {
      const double px = diameter(i);
      planes_.push_back(gaussian(px > 0 ? blurred_by(Disc(px), texture) : texture, kLens));
    }
  }
  float at(std::size_t pixel, double px) const {
    const double place = px < diameter(kFine) ? px / kFinePx : kFine + (px - diameter(kFine)) / kPx;
    const auto i = std::min(static_cast<std::size_t>(place), planes_.size() - 2);
    const auto part = static_cast<float>(place - static_cast<double>(i));
    return planes_[i].values[pixel] * (1 - part) + planes_[i + 1].values[pixel] * part;
  }

 private:
  static constexpr int kFine = 3;
  static constexpr double kFinePx = 0.4, kPx = 0.8;
  static double diameter(int i) {
    return i <= kFine ? i * kFinePx : kFine * kFinePx + (i - kFine) * kPx;
  }

  std::vector<Plane> planes_;
};

float depth_at(Shape shape, double u, double v, double low, double high) {
  constexpr double kPi = std::numbers::pi;
  double depth = low;
  switch (shape) {
    case Shape::slope:
      depth = low + (high - low) * u;
      break;
    case Shape::cone:
      depth = high - (high - low) * std::min(2 * std::hypot(u - 0.5, v - 0.5), 1.0);
      break;
    case Shape::waves:
      depth = (low + high) / 2 +
              (high - low) / 2 * std::sin(2 * kPi * 2 * u) * std::cos(2 * kPi * 1.5 * v);
      break;
    case Shape::step:
      depth = u > 0.35 && u < 0.65 && v > 0.3 && v < 0.7 ? high - 1 : low + 1;
      break;
  }
  return static_cast<float>(depth);
}

std::vector<float> depth_of(const DepthAt& depth_at, const Options& options) {
  std::vector<float> depth;
  for (int y = 0; y < options.height_px; ++y) {
    for (int x = 0; x < options.width_px; ++x) {
      depth.push_back(depth_at(static_cast<double>(x) / options.width_px,
                               static_cast<double>(y) / options.height_px));
    }
  }
  return depth;
}

DepthAt shaped(Shape shape, const Options& options) {
  const double low = 0.12 * (options.frames - 1), high = 0.88 * (options.frames - 1);
  return [=](double u, double v) { return depth_at(shape, u, v, low, high); };
}

}  // namespace

const char* to_string(Texture texture) noexcept {
  switch (texture) {
    case Texture::pink:
      return "pink";
    case Texture::white:
      return "white";
    case Texture::sparse:
      return "sparse";
    case Texture::faint:
      return "faint";
  }
  return "unknown";
}

const char* to_string(Shape shape) noexcept {
  switch (shape) {
    case Shape::slope:
      return "slope";
    case Shape::cone:
      return "cone";
    case Shape::waves:
      return "waves";
    case Shape::step:
      return "step";
  }
  return "unknown";
}

std::vector<float> depth_of(Shape shape, const Options& options) {
  return depth_of(shaped(shape, options), options);
}

Scene make(Texture texture, Shape shape, const Options& options) {
  return make(texture, shaped(shape, options), options);
}

Scene make(Texture texture, const DepthAt& depth_at, const Options& options) {
  std::mt19937 random(options.seed);
  const Plane sharp = texture_of(texture, options, random);
  const Blurred blurred(sharp, options.px_per_frame * options.frames);
  Scene scene{{}, depth_of(depth_at, options)};
  std::normal_distribution<double> normal;
  for (int z = 0; z < options.frames; ++z) {
    std::vector<std::uint8_t> pixels;
    for (std::size_t i = 0; i < scene.depth.size(); ++i) {
      const double grey =
          blurred.at(i, options.px_per_frame * std::abs(static_cast<float>(z) - scene.depth[i]));
      const double noise = std::sqrt(std::max(grey, 0.0) * 0.02 + 0.6) * options.noise;
      const double seen = std::round(grey + noise * normal(random));
      pixels.push_back(static_cast<std::uint8_t>(std::clamp(seen, 0.0, 255.0)));
    }
    scene.frames.emplace_back(options.width_px, options.height_px, std::move(pixels));
  }
  return scene;
}

}  // namespace fathom::scenes
