// SPDX-License-Identifier: Apache-2.0
#include "depth/upsample.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "depth/parallel.hpp"

namespace fathom::depth {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// What is blended at a pixel.
struct Blend {
  float place = 0, sigma = 0, confidence = 0, known = 0;
  float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
  float heaviest = 0;  ///< Weight of the piece that `why` is of.
  DepthClass why = DepthClass::no_texture;

  void add(const Facet& facet, float dx_px, float dy_px, float weight) {
    if (facet.kind != DepthClass::known) {
      if (weight > heaviest) why = facet.kind;
      heaviest = std::max(weight, heaviest);
      return;
    }
    const float here = facet.place + facet.slope_x * dx_px + facet.slope_y * dy_px;
    low = std::min(low, here);
    high = std::max(high, here);
    place += weight * here;
    sigma += weight * facet.sigma;
    confidence += weight * facet.confidence;
    known += weight;
  }
};

/// Along one axis: the first of two nodes, and where a pixel lies from it, in pixels and in parts of
/// the way to the second. Beyond the last node the part stays 0 or 1.
struct Spot {
  int node = 0;
  float from_px = 0;
  float part = 0;
};

std::vector<Spot> spots(int pixels, const Level& level, int nodes) {
  std::vector<Spot> all(pixels);
  for (int i = 0; i < pixels; ++i) {
    const double place = (i - level.first_px()) / level.pitch_px();
    const int node = std::clamp(static_cast<int>(std::floor(place)), 0, nodes - 2);
    all[i] = {node, static_cast<float>(i - level.first_px() - node * level.pitch_px()),
              static_cast<float>(std::clamp(place - node, 0.0, 1.0))};
  }
  return all;
}

class Upsampling {
 public:
  Upsampling(const Surface& surface, const FocusGrid& grid, const Scales& scales, DepthMaps& maps)
      : surface_(surface),
        grid_(grid),
        scales_(scales),
        maps_(maps),
        across_(spots(maps.width_px, surface.level, surface.level.columns)),
        down_(spots(maps.height_px, surface.level, surface.level.rows)) {}

  void rows(int first, int end) {
    for (int y = first; y < end; ++y) {
      for (int x = 0; x < maps_.width_px; ++x) {
        write(static_cast<std::size_t>(y) * maps_.width_px + x, blend_at(across_[x], down_[y]));
      }
    }
  }

 private:
  Blend blend_at(const Spot& u, const Spot& v) const {
    const auto pitch = static_cast<float>(surface_.level.pitch_px());
    const float right_px = u.from_px - pitch, below_px = v.from_px - pitch;
    Blend blend;
    blend.add(surface_.at(u.node, v.node), u.from_px, v.from_px, (1 - u.part) * (1 - v.part));
    blend.add(surface_.at(u.node + 1, v.node), right_px, v.from_px, u.part * (1 - v.part));
    blend.add(surface_.at(u.node, v.node + 1), u.from_px, below_px, (1 - u.part) * v.part);
    blend.add(surface_.at(u.node + 1, v.node + 1), right_px, below_px, u.part * v.part);
    return blend;
  }

  void write(std::size_t pixel, const Blend& blend) {
    constexpr float kSigmas = 3;
    DepthClass kind = DepthClass::known;
    if (blend.known < 0.5f) {
      kind = blend.why;
    } else if (blend.high - blend.low > scales_.apart + kSigmas * blend.sigma / blend.known) {
      kind = DepthClass::two_depths;
    }
    maps_.classes[pixel] = kind;
    const bool is_known = kind == DepthClass::known;
    const auto step = static_cast<float>(grid_.step);
    const float place = blend.place / blend.known;
    maps_.position[pixel] = is_known ? static_cast<float>(grid_.low) + step * place : kUnknown;
    maps_.sigma[pixel] = is_known ? step * blend.sigma / blend.known : kUnknown;
    maps_.confidence[pixel] = is_known ? blend.confidence / blend.known : kUnknown;
  }

  const Surface& surface_;
  const FocusGrid& grid_;
  const Scales& scales_;
  DepthMaps& maps_;
  std::vector<Spot> across_, down_;
};

}  // namespace

DepthMaps upsample(const Surface& surface, int width_px, int height_px, const FocusGrid& grid,
                   const Scales& scales, int threads) {
  const std::size_t pixels = static_cast<std::size_t>(width_px) * height_px;
  DepthMaps maps{.width_px = width_px,
                 .height_px = height_px,
                 .position = std::vector<float>(pixels),
                 .sigma = std::vector<float>(pixels),
                 .confidence = std::vector<float>(pixels),
                 .classes = std::vector<DepthClass>(pixels),
                 .lowest = static_cast<float>(grid.low),
                 .highest = static_cast<float>(grid.at(grid.size - 1))};
  Upsampling upsampling(surface, grid, scales, maps);
  share_out(height_px, 32, threads, [&](std::size_t first, std::size_t end) {
    upsampling.rows(static_cast<int>(first), static_cast<int>(end));
  });
  return maps;
}

}  // namespace fathom::depth
