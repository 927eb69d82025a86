// SPDX-License-Identifier: Apache-2.0
#include "bench/depth/peers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom::peers {
namespace {

struct Plane {
  int width = 0, height = 0;
  std::vector<float> values;

  Plane(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
  /// Outside of the picture, its mirror image.
  float at(int x, int y) const { return values[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(mirrored(y, height)) * width + mirrored(x, width);
  }

 private:
  static int mirrored(int i, int n) { return i < 0 ? -1 - i : i >= n ? 2 * n - 1 - i : i; }
};

Plane plane_of(const Frame& frame) {
  Plane plane(frame.width_px(), frame.height_px());
  for (int y = 0; y < plane.height; ++y) {
    for (int x = 0; x < plane.width; ++x) {
      plane.values[plane.index(x, y)] = static_cast<float>(frame.at(x, y));
    }
  }
  return plane;
}

/// Mean over a square, by running sums along both axes.
Plane mean_of(const Plane& in, int side) {
  const int reach = side / 2;
  Plane across(in.width, in.height), out(in.width, in.height);
  for (int y = 0; y < in.height; ++y) {
    double sum = 0;
    for (int x = -reach; x < reach; ++x) sum += in.at(x, y);
    for (int x = 0; x < in.width; ++x) {
      sum += in.at(x + reach, y);
      across.values[across.index(x, y)] = static_cast<float>(sum / side);
      sum -= in.at(x - reach, y);
    }
  }
  for (int x = 0; x < in.width; ++x) {
    double sum = 0;
    for (int y = -reach; y < reach; ++y) sum += across.at(x, y);
    for (int y = 0; y < in.height; ++y) {
      sum += across.at(x, y + reach);
      out.values[out.index(x, y)] = static_cast<float>(sum / side);
      sum -= across.at(x, y - reach);
    }
  }
  return out;
}

template <class Of>
Plane combined(const Plane& a, const Plane& b, const Of& of) {
  Plane out(a.width, a.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = of(a.values[i], b.values[i]);
  return out;
}

Plane product(const Plane& a, const Plane& b) {
  return combined(a, b, [](float x, float y) { return x * y; });
}

Plane guided(const Plane& in, const Plane& guide, int radius, float epsilon) {
  const int side = 2 * radius + 1;
  const Plane mean_guide = mean_of(guide, side), mean = mean_of(in, side);
  const Plane both = mean_of(product(guide, in), side),
              square = mean_of(product(guide, guide), side);
  Plane slope(in.width, in.height), offset(in.width, in.height);
  for (std::size_t i = 0; i < slope.values.size(); ++i) {
    const float covariance = both.values[i] - mean_guide.values[i] * mean.values[i];
    const float variance = square.values[i] - mean_guide.values[i] * mean_guide.values[i];
    slope.values[i] = covariance / (variance + epsilon);
    offset.values[i] = mean.values[i] - slope.values[i] * mean_guide.values[i];
  }
  return combined(product(mean_of(slope, side), guide), mean_of(offset, side),
                  [](float x, float y) { return x + y; });
}

Plane modified_laplacian(const Frame& frame) {
  const Plane grey = plane_of(frame);
  Plane out(grey.width, grey.height);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const float here = 2 * grey.at(x, y);
      out.values[out.index(x, y)] = std::abs(here - grey.at(x - 1, y) - grey.at(x + 1, y)) +
                                    std::abs(here - grey.at(x, y - 1) - grey.at(x, y + 1));
    }
  }
  return out;
}

Plane ring_difference(const Frame& frame) {
  constexpr int kReach = 4;
  constexpr double kInner = 1.2, kRingFrom = 2.5, kRingTo = 4.3;
  struct Tap {
    int x, y;
    float weight;
  };
  std::vector<Tap> taps;
  double inner = 0, outer = 0;
  for (const bool counts : {true, false}) {
    for (int y = -kReach; y <= kReach; ++y) {
      for (int x = -kReach; x <= kReach; ++x) {
        const double r = std::hypot(x, y);
        const bool is_inner = r <= kInner, is_ring = r > kRingFrom && r <= kRingTo;
        if (counts) {
          inner += is_inner;
          outer += is_ring;
        } else if (is_inner || is_ring) {
          taps.push_back({x, y, static_cast<float>(is_inner ? 1 / inner : -1 / outer)});
        }
      }
    }
  }
  const Plane grey = plane_of(frame);
  Plane out(grey.width, grey.height);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      float sum = 0;
      for (const Tap& tap : taps) sum += tap.weight * grey.at(x + tap.x, y + tap.y);
      out.values[out.index(x, y)] = sum * sum;
    }
  }
  return out;
}

/// A Gaussian through the highest of the volume's values and its neighbours.
std::vector<float> peaks(const std::vector<Plane>& volume) {
  constexpr float kLeast = 1e-12f;
  std::vector<float> depth(volume[0].values.size());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    std::size_t best = 0;
    for (std::size_t z = 1; z < volume.size(); ++z) {
      if (volume[z].values[i] > volume[best].values[i]) best = z;
    }
    best = std::clamp<std::size_t>(best, 1, volume.size() - 2);
    std::array<float, 3> logs;
    for (std::size_t k = 0; k < 3; ++k) {
      logs[k] = std::log(std::max(volume[best - 1 + k].values[i], kLeast));
    }
    const float bend = logs[0] - 2 * logs[1] + logs[2];
    const float offset = bend < 0 ? 0.5f * (logs[0] - logs[2]) / bend : 0;
    depth[i] = static_cast<float>(best) + std::clamp(offset, -1.0f, 1.0f);
  }
  return depth;
}

std::vector<float> median_of_nine(const std::vector<float>& depth, int width, int height) {
  Plane plane(width, height);
  plane.values = depth;
  std::vector<float> out(depth.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::array<float, 9> near;
      for (int i = 0; i < 9; ++i) near[i] = plane.at(x + i % 3 - 1, y + i / 3 - 1);
      std::nth_element(near.begin(), near.begin() + 4, near.end());
      out[plane.index(x, y)] = near[4];
    }
  }
  return out;
}

/// Of all frames, each pixel from where the volume is highest.
Plane all_in_focus(std::span<const Frame> frames, const std::vector<Plane>& volume) {
  Plane out(volume[0].width, volume[0].height);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const std::size_t i = out.index(x, y);
      std::size_t best = 0;
      for (std::size_t z = 1; z < volume.size(); ++z) {
        if (volume[z].values[i] > volume[best].values[i]) best = z;
      }
      out.values[i] = static_cast<float>(frames[best].at(x, y)) / 255;
    }
  }
  return out;
}

}  // namespace

std::vector<float> sum_of_modified_laplacian(std::span<const Frame> frames, int side_px) {
  std::vector<Plane> volume;
  for (const Frame& frame : frames) volume.push_back(mean_of(modified_laplacian(frame), side_px));
  return median_of_nine(peaks(volume), volume[0].width, volume[0].height);
}

std::vector<float> ring_difference_filter(std::span<const Frame> frames) {
  constexpr int kChoice = 5, kRadius = 10;
  constexpr float kEpsilon = 1e-3f, kLeast = 1e-9f;
  std::vector<Plane> volume, smooth;
  for (const Frame& frame : frames) {
    volume.push_back(ring_difference(frame));
    smooth.push_back(mean_of(volume.back(), kChoice));
  }
  const Plane guide = all_in_focus(frames, smooth);
  for (std::size_t i = 0; i < guide.values.size(); ++i) {
    float most = kLeast;
    for (const Plane& plane : volume) most = std::max(most, plane.values[i]);
    for (Plane& plane : volume) plane.values[i] /= most;
  }
  for (Plane& plane : volume) plane = guided(plane, guide, kRadius, kEpsilon);
  for (Plane& plane : volume) {
    for (float& value : plane.values) value = std::max(value, kLeast);
  }
  return peaks(volume);
}

}  // namespace fathom::peers
