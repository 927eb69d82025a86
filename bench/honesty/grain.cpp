// SPDX-License-Identifier: Apache-2.0
#include "bench/honesty/grain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace fathom::honesty {
namespace {

using Greys = std::vector<double>;

/// ITU-T T.81, table K.1: the steps of luminance at quality 50.
constexpr std::array<int, 64> kSteps = {
    16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
    14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,
    18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
    49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};

/// The step at a quality, as the Independent JPEG Group scales it.
double step_of(std::size_t i, double quality) {
  const double scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  return std::clamp(std::floor((kSteps[i] * scale + 50) / 100), 1.0, 255.0);
}

/// Orthonormal cosine k of 8 at x.
double cosine(int k, int x) {
  return (k == 0 ? std::sqrt(1.0 / 8) : 0.5) * std::cos((2 * x + 1) * k * std::numbers::pi / 16);
}

using Block = std::array<double, 64>;

/// Along both axes; back: from coefficients.
Block transformed(const Block& block, bool back) {
  Block rows{}, all{};
  const auto wave = [back](int i, int k) { return back ? cosine(k, i) : cosine(i, k); };
  for (int y = 0; y < 8; ++y) {
    for (int i = 0; i < 8; ++i) {
      for (int k = 0; k < 8; ++k) rows[y * 8 + i] += wave(i, k) * block[y * 8 + k];
    }
  }
  for (int i = 0; i < 8; ++i) {
    for (int x = 0; x < 8; ++x) {
      for (int k = 0; k < 8; ++k) all[i * 8 + x] += wave(i, k) * rows[k * 8 + x];
    }
  }
  return all;
}

/// What a JPEG keeps: every coefficient of 8 x 8 pixels, rounded to its step.
Greys as_jpeg(Greys greys, int side, double quality) {
  for (int top = 0; top < side; top += 8) {
    for (int left = 0; left < side; left += 8) {
      const auto at = [&](int i) { return (top + i / 8) * side + left + i % 8; };
      Block block;
      for (int i = 0; i < 64; ++i) block[i] = std::clamp(std::round(greys[at(i)]), 0., 255.) - 128;
      block = transformed(block, false);
      for (std::size_t i = 0; i < 64; ++i) {
        const double step = step_of(i, quality);
        block[i] = step * std::round(block[i] / step);
      }
      block = transformed(block, true);
      for (int i = 0; i < 64; ++i) greys[at(i)] = block[i] + 128;
    }
  }
  return greys;
}

/// Convolved along one axis with a kernel of odd length, on a torus. step: 1, or side for columns.
Greys along(const Greys& greys, int side, int step, const Greys& kernel) {
  const int radius = static_cast<int>(kernel.size() / 2);
  Greys sums(greys.size());
  for (int i = 0; i < side * side; ++i) {
    const int x = i / step % side, start = i - x * step;
    for (int k = -radius; k <= radius; ++k)
      sums[i] += kernel[k + radius] * greys[start + (x + k + side) % side * step];
  }
  return sums;
}

Greys convolved(const Greys& greys, int side, const Greys& kernel) {
  return along(along(greys, side, 1, kernel), side, side, kernel);
}

Greys smoothed(const Greys& greys, int side, double sigma_px) {
  Greys kernel;
  double sum = 0;
  for (int i = -8; i <= 8; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (sigma_px * sigma_px)));
    sum += kernel.back();
  }
  for (double& weight : kernel) weight /= sum;
  return convolved(greys, side, kernel);
}

/// Grey of what a Bayer sensor (GRBG) sees of a grey scene, its colours interpolated linearly.
Greys demosaiced(const Greys& raw, int side) {
  constexpr double kLuma[] = {0.299, 0.587, 0.114};
  Greys grey(raw.size());
  for (int colour = 0; colour < 3; ++colour) {
    Greys seen(raw.size()), there(raw.size());
    for (int i = 0; i < side * side; ++i) {
      const int x = i % side % 2, y = i / side % 2;
      const int its = x == y ? 1 : y == 0 ? 0 : 2;
      seen[i] = its == colour ? raw[i] : 0;
      there[i] = its == colour ? 1 : 0;
    }
    seen = convolved(seen, side, {0.5, 1, 0.5});
    there = convolved(there, side, {0.5, 1, 0.5});
    for (std::size_t i = 0; i < grey.size(); ++i) grey[i] += kLuma[colour] * seen[i] / there[i];
  }
  return grey;
}

double shrunk(double value, double by) {
  return std::copysign(std::max(0.0, std::abs(value) - by), value);
}

/// Haar's wavelets of squares of 2, 4 and 8 pixels, less a threshold.
Greys denoised(Greys greys, int side, double threshold) {
  for (int span = 1; span <= 4; span *= 2) {
    for (int y = 0; y < side; y += 2 * span) {
      for (int x = 0; x < side; x += 2 * span) {
        // The means of the four quarters stand at their corners.
        double* const a = &greys[y * side + x];
        double &b = a[span], &c = a[span * side], &d = a[span * side + span];
        const double mean = (*a + b + c + d) / 2, h = shrunk((*a - b + c - d) / 2, threshold);
        const double v = shrunk((*a + b - c - d) / 2, threshold);
        const double e = shrunk((*a - b - c + d) / 2, threshold);
        b = h, c = v, d = e;
        *a = mean;
      }
    }
  }
  for (int span = 4; span >= 1; span /= 2) {
    for (int y = 0; y < side; y += 2 * span) {
      for (int x = 0; x < side; x += 2 * span) {
        double* const a = &greys[y * side + x];
        double &b = a[span], &c = a[span * side], &d = a[span * side + span];
        const double mean = *a, h = b, v = c, e = d;
        *a = (mean + h + v + e) / 2, b = (mean - h + v - e) / 2;
        c = (mean + h - v - e) / 2, d = (mean - h - v + e) / 2;
      }
    }
  }
  return greys;
}

}  // namespace

std::vector<double> grained(std::vector<double> greys, int side, Grain grain, double strength,
                            double deviation) {
  switch (grain) {
    case Grain::white:
      return greys;
    case Grain::jpeg:
      return as_jpeg(std::move(greys), side, std::round(95 - 65 * strength));
    case Grain::demosaiced:
      return demosaiced(greys, side);
    case Grain::smoothed:
      return smoothed(greys, side, 0.7 + 1.3 * strength);
    case Grain::denoised:
      return denoised(std::move(greys), side, 3 * strength * deviation);
  }
  return greys;
}

}  // namespace fathom::honesty
