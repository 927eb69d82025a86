// SPDX-License-Identifier: Apache-2.0
// The connected parts of made maps, and the windows within them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "depth/surfaces.hpp"
#include "engine/error.hpp"

namespace fathom {
namespace {

constexpr int kWidth = 256, kHeight = 192;
constexpr float kReach = 24;

/// A map whose reach of 24 px is that of nodes of 16 px, with positions with this noise, as neighbours share it.
template <class PositionAt>
DepthMaps map_of(const PositionAt& position_at, float noise = 0.3f, float shared = 0.5f,
                 unsigned seed = 1) {
  constexpr int kNodePx = 16;
  DepthMaps maps{.width_px = kWidth,
                 .height_px = kHeight,
                 .position = {},
                 .sigma = std::vector<float>(kWidth * kHeight, std::hypot(noise, shared)),
                 .confidence = std::vector<float>(kWidth * kHeight, 1),
                 .classes = std::vector<DepthClass>(kWidth * kHeight, DepthClass::known),
                 .shared_sigma = shared,
                 .reach_px = kReach};
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0, noise);
  constexpr int kNodes = kWidth / kNodePx + 2;
  std::vector<float> nodes(kNodes * kNodes);
  for (float& node : nodes) node = normal(random);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto u = static_cast<float>(x % kNodePx) / kNodePx;
      const auto v = static_cast<float>(y % kNodePx) / kNodePx;
      const float* const node = nodes.data() + y / kNodePx * kNodes + x / kNodePx;
      const float off = (1 - v) * ((1 - u) * node[0] + u * node[1]) +
                        v * ((1 - u) * node[kNodes] + u * node[kNodes + 1]);
      maps.position.push_back(position_at(x, y) + off);
    }
  }
  return maps;
}

void forget(DepthMaps& maps, int x, int y, DepthClass kind = DepthClass::no_texture) {
  const int pixel = y * kWidth + x;
  maps.classes[pixel] = kind;
  maps.position[pixel] = maps.sigma[pixel] = maps.confidence[pixel] =
      std::numeric_limits<float>::quiet_NaN();
}

template <class IsHole>
void forget_where(DepthMaps& maps, const IsHole& is_hole,
                  DepthClass kind = DepthClass::no_texture) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (is_hole(x, y)) forget(maps, x, y, kind);
    }
  }
}

/// A cliff as windows smear it: a ramp of 16 px about `edge`.
float smeared_step(int x, int edge) {
  return std::clamp((static_cast<float>(x - edge) + 8) / 16, 0.0f, 1.0f);
}

/// The sharp picture: noise, stronger in a box.
Frame picture(int left = 0, int top = 0, int right = 0, int bottom = 0) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> weak(100, 110), strong(40, 200);
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool is_strong = x >= left && x < right && y >= top && y < bottom;
      pixels.push_back(static_cast<std::uint8_t>(is_strong ? strong(random) : weak(random)));
    }
  }
  return Frame(kWidth, kHeight, std::move(pixels));
}

TEST(Surfaces, FindEveryStepOfASmearedStair) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto stair = [](int x, int) {
      return 100 + 8 * (smeared_step(x, 64) + smeared_step(x, 128) + smeared_step(x, 192));
    };
    const Surfaces surfaces = find_surfaces(map_of(stair, 0.3f, 0.5f, seed));
    ASSERT_EQ(surfaces.found.size(), 4u) << "seed " << seed;
    for (const SeenSurface& surface : surfaces.found) {
      const int band = static_cast<int>(surface.centre_x) / 64;
      EXPECT_NEAR(surface.position, 100 + 8 * band, 3 * surface.sigma) << "seed " << seed;
      EXPECT_NEAR(surface.position, 100 + 8 * band, 0.5) << "seed " << seed;
      EXPECT_NEAR(surface.centre_x, 64 * band + 31.5, 6);
      EXPECT_GT(surface.area_px, 0.8 * 64 * kHeight);
      EXPECT_NEAR(surface.box.x, 64 * band, 8);
      EXPECT_LT(surface.spread, 1.5);
    }
    EXPECT_EQ(surfaces.small, 0u);
  }
}

TEST(Surfaces, FollowSlopesAndBends) {
  const auto slope = [](int x, int y) {
    return 10 + 0.5f * static_cast<float>(x) - 0.2f * static_cast<float>(y);
  };
  const Surfaces steep = find_surfaces(map_of(slope, 0.05f, 0.1f));
  ASSERT_EQ(steep.found.size(), 1u);
  const SeenSurface& plane = steep.found[0];
  EXPECT_NEAR(plane.slope_x, 0.5, 0.01);
  EXPECT_NEAR(plane.slope_y, -0.2, 0.01);
  EXPECT_NEAR(plane.position, slope(127, 95), 1);
  EXPECT_GT(plane.area_px, 0.95 * kWidth * kHeight);
  EXPECT_NEAR(plane.spread, std::hypot(0.5 * kWidth, 0.2 * kHeight) / std::sqrt(12), 2);

  // A paraboloid: twice as steep at its edge as anything between two nodes of a flat map.
  const auto bowl = [](int x, int y) {
    return 0.004f * (std::pow(static_cast<float>(x - 128), 2.0f) +
                     std::pow(static_cast<float>(y - 96), 2.0f));
  };
  EXPECT_EQ(find_surfaces(map_of(bowl, 0.05f, 0.1f)).found.size(), 1u);
}

TEST(Surfaces, AreNoMoreForNoise) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Surfaces surfaces = find_surfaces(map_of([](int, int) { return 50.0f; }, 1, 0.2f, seed));
    EXPECT_EQ(surfaces.found.size(), 1u) << "seed " << seed;
    const SeenSurface& flat = surfaces.found.at(0);
    EXPECT_NEAR(flat.position, 50, 3 * flat.sigma) << "seed " << seed;
  }
}

TEST(Surfaces, AreAsSureAsTheirIndependentWindows) {
  constexpr unsigned kSeeds = 60;
  double squares = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const DepthMaps maps = map_of([](int, int) { return 50.0f; }, 1, 0, seed);
    const SeenSurface flat = find_surfaces(maps).found.at(0);
    squares += std::pow((flat.position - 50) / flat.sigma, 2);
    // 192 nodes of independent noise; bilinear interpolation takes some of each.
    EXPECT_NEAR(flat.sigma, 1 / std::sqrt(kWidth * kHeight / (kReach * kReach)), 0.01);
  }
  EXPECT_GT(std::sqrt(squares / kSeeds), 0.5);
  EXPECT_LT(std::sqrt(squares / kSeeds), 1.5);
  // What all places share stays.
  const DepthMaps shared = map_of([](int, int) { return 50.0f; }, 0.01f, 0.7f);
  EXPECT_NEAR(find_surfaces(shared).found.at(0).sigma, 0.7, 0.01);
}

TEST(Surfaces, KeepHolesOutAndBridgesApart) {
  DepthMaps pitted = map_of([](int, int) { return 50.0f; });
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i)
    forget(pitted, static_cast<int>(random() % kWidth), static_cast<int>(random() % kHeight));
  forget_where(pitted, [](int x, int y) { return std::hypot(x - 128, y - 96) < 40; });
  const Surfaces ring = find_surfaces(pitted);
  ASSERT_EQ(ring.found.size(), 1u);
  const auto known =
      static_cast<std::size_t>(std::ranges::count(pitted.classes, DepthClass::known));
  EXPECT_LE(ring.found[0].area_px, known);
  EXPECT_GT(static_cast<double>(ring.found[0].area_px), 0.9 * static_cast<double>(known));

  for (const int bridge_px : {1, 4, 8}) {
    DepthMaps apart = map_of([](int, int) { return 50.0f; });
    const auto is_cliff = [&](int x, int y) {
      return std::abs(x - 128) < 10 && !(y >= 96 && y < 96 + bridge_px);
    };
    forget_where(apart, is_cliff, DepthClass::two_depths);
    EXPECT_EQ(find_surfaces(apart).found.size(), 2u) << bridge_px;
  }
  DepthMaps joined = map_of([](int, int) { return 50.0f; });
  forget_where(joined, [](int x, int y) { return std::abs(x - 128) < 10 && y > 60; });
  EXPECT_EQ(find_surfaces(joined).found.size(), 1u);
}

/// Blank bands, one upright and one level, of this width.
bool is_blank(int x, int y, int width) {
  return std::abs(x - 128) < width / 2 || std::abs(y - 96) < width / 2;
}

TEST(Surfaces, AreOneAcrossWhatHasNoTexture) {
  const auto flat = [](int, int) { return 50.0f; };
  const auto leaning = [](int x, int y) { return 0.2f * static_cast<float>(x + y); };
  for (const DepthClass kind : {DepthClass::no_texture, DepthClass::two_depths}) {
    for (const int gap_px : {20, 60}) {
      // Noise may make two depths of what is blank; then the picture tells.
      const Frame sharp = picture(0, 0, kWidth, kHeight);
      std::vector<std::uint8_t> pixels;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x)
          pixels.push_back(is_blank(x, y, gap_px) ? 100
                                                  : static_cast<std::uint8_t>(sharp.at(x, y)));
      }
      const Frame seen(kWidth, kHeight, std::move(pixels));
      for (const bool leans : {false, true}) {
        DepthMaps maps = leans ? map_of(leaning, 0.1f, 0.2f) : map_of(flat, 0.1f, 0.2f);
        forget_where(
            maps, [&](int x, int y) { return is_blank(x, y, gap_px); }, kind);
        const Surfaces surfaces = find_surfaces(maps, &seen);
        ASSERT_EQ(surfaces.found.size(), 1u) << to_string(kind) << gap_px << leans;
        EXPECT_EQ(surfaces.found[0].pieces, 4);
        EXPECT_NEAR(surfaces.found[0].slope_x, leans ? 0.2 : 0, 0.01);
      }
    }
  }
}

TEST(Surfaces, StayApartAcrossWhatHasNoTextureWhereNoPlaneHoldsBoth) {
  for (const bool leans : {false, true}) {
    const auto stair = [&](int x, int y) {
      const float step = x < 128 ? 50 : 53;
      return step + (leans ? 0.05f * static_cast<float>(x + y) : 0);
    };
    DepthMaps maps = map_of(stair, 0.3f, 0.3f);
    forget_where(maps, [](int x, int) { return std::abs(x - 128) < 20; });
    EXPECT_EQ(find_surfaces(maps).found.size(), 2u) << leans;
  }
  // Both slopes are sure, and they are not the same.
  DepthMaps roof =
      map_of([](int x, int) { return 0.2f * static_cast<float>(std::abs(x - 128)); }, 0.1f, 0.2f);
  forget_where(roof, [](int x, int) { return std::abs(x - 128) < 20; });
  EXPECT_EQ(find_surfaces(roof).found.size(), 2u);
}

TEST(Surfaces, KnowOfTheirReliefWhatNoiseDoesNotExplain) {
  const SeenSurface flat =
      find_surfaces(map_of([](int, int) { return 50.0f; }, 1, 0.2f)).found.at(0);
  EXPECT_LT(flat.relief, 0.6);
  const auto slope = [](int x, int) { return 0.1f * static_cast<float>(x); };
  const SeenSurface leaning = find_surfaces(map_of(slope, 1, 0.2f)).found.at(0);
  EXPECT_NEAR(leaning.relief, 0.1 * kWidth / std::sqrt(12), 0.5);
  EXPECT_LT(leaning.sigma, 0.5);
}

TEST(Surfaces, LeaveSmallPartsAndFilledPlacesOut) {
  DepthMaps maps = map_of([](int x, int y) {
    const bool is_speck = std::abs(x - 60) < 26 && std::abs(y - 60) < 26;
    const bool is_card = std::abs(x - 180) < 40 && std::abs(y - 96) < 40;
    return is_speck ? 90.0f : is_card ? 70.0f : 50.0f;
  });
  const Surfaces surfaces = find_surfaces(maps);
  ASSERT_EQ(surfaces.found.size(), 2u);
  EXPECT_EQ(surfaces.small, 1u);
  EXPECT_NEAR(surfaces.found[0].position, 50, 0.5);
  EXPECT_NEAR(surfaces.found[1].position, 70, 0.5);
  EXPECT_NEAR(surfaces.found[1].centre_x, 180, 3);

  std::ranges::fill(maps.classes, DepthClass::filled);
  EXPECT_TRUE(find_surfaces(maps).found.empty());
}

TEST(Surfaces, ShareTheTextureAndRefuseAnotherPicture) {
  const DepthMaps maps = map_of([](int x, int) { return x < 128 ? 50.0f : 80.0f; });
  const Frame sharp = picture(0, 0, 128, kHeight);
  const Surfaces surfaces = find_surfaces(maps, &sharp);
  ASSERT_EQ(surfaces.found.size(), 2u);
  double all = 0;
  for (const SeenSurface& surface : surfaces.found) {
    all += surface.texture;
    EXPECT_EQ(surface.position<60, surface.texture> 0.95);
  }
  EXPECT_NEAR(all, 1, 0.02);
  const Frame small(64, 64, std::vector<std::uint8_t>(64 * 64));
  EXPECT_THROW(find_surfaces(maps, &small), Error);
}

TEST(RichestWindow, LiesWithinOneSurfaceWhereItsTextureIs) {
  const DepthMaps maps = map_of([](int x, int) { return x < 128 ? 50.0f : 80.0f; });
  // The strongest texture lies on the cliff, and the most of one depth to its left.
  const Frame sharp = picture(40, 60, 180, 140);
  const Surfaces surfaces = find_surfaces(maps, &sharp);
  const auto best = richest_window(surfaces, 64);
  ASSERT_TRUE(best);
  EXPECT_NEAR(surfaces.found[static_cast<std::size_t>(best->surface)].position, 50, 1);
  EXPECT_GE(best->window.x, 36);
  EXPECT_LE(best->window.x + 64, 130);
  EXPECT_NEAR(best->window.y, 68, 10);
  const int other = 1 - best->surface;
  const auto right = richest_window(surfaces, 32, other);
  ASSERT_TRUE(right);
  EXPECT_EQ(right->surface, other);
  EXPECT_GE(right->window.x, 124);
  EXPECT_LE(right->window.x, 152);
  EXPECT_FALSE(richest_window(surfaces, 256));
}

TEST(RichestWindow, WouldRatherBeFlat) {
  // Steep on the left, flat on the right, and as much texture everywhere.
  const auto bent = [](int x, int) { return x < 128 ? 0.4f * static_cast<float>(128 - x) : 0.0f; };
  const Frame sharp = picture(0, 0, kWidth, kHeight);
  const auto best = richest_window(find_surfaces(map_of(bent, 0.1f, 0.3f), &sharp), 64);
  ASSERT_TRUE(best);
  EXPECT_GE(best->window.x, 116);
}

}  // namespace
}  // namespace fathom
