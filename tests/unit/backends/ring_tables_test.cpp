// SPDX-License-Identifier: Apache-2.0
// The rings as the cpu kernels read them, against their definition, and when their means in float
// are trusted: docs/metrics.md, "Rings in float".
#include "backends/cpu/ring_tables.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>

#include "backends/cpu/tables.hpp"
#include "tests/support/oracle_compare.hpp"
#include "tests/unit/backends/cpu_devices.hpp"

namespace fathom::cpu {
namespace {

constexpr int kNone = -1;

std::vector<MetricSpec> specs(Transform transform) {
  std::vector<MetricSpec> all;
  const std::string name = to_string(transform);
  for (const char* rest : {":8:rings=3", ":16:rings=8", ":32:rings=16", ":32:band=0.2-0.7:rings=16",
                           ":64:rings=16", ":64:power:rings=32", ":64:band=0.1-0.4:rings=5",
                           ":128:band=0-0.7:rings=32", ":256:rings=7"}) {
    all.push_back(MetricSpec::parse(name + rest));
  }
  return all;
}

/// The definition: e(k) < r <= e(k + 1), r in cycles per window, squares compared.
int ring_of(const MetricSpec& spec, double squared_radius) {
  const double low = spec.band ? spec.band->low : 0, high = spec.band ? spec.band->high : 0.5;
  const auto edge = [&](int k) { return (low + (high - low) * k / spec.rings) * spec.n; };
  for (int k = 0; k < spec.rings; ++k) {
    if (edge(k) * edge(k) < squared_radius && squared_radius <= edge(k + 1) * edge(k + 1)) return k;
  }
  return kNone;
}

int fourier_ring(const MetricSpec& spec, int u, int v) { return ring_of(spec, u * u + v * v); }

int walsh_ring(const MetricSpec& spec, int i, int j) {
  return ring_of(spec, (static_cast<double>(i) * i + static_cast<double>(j) * j) / 4);
}

TEST(RingTables, SayWhichRingAPositionIsIn) {
  for (const MetricSpec& spec : specs(Transform::fft)) {
    SCOPED_TRACE(spec.text());
    const RingTables rings(spec);
    const auto frequency = frequency_by_position(spec.n);
    const auto near = [&](int k) { return std::min(k, spec.n - k); };
    for (int p = 0; p < spec.n; ++p) {
      for (int q = 0; q < spec.n; ++q) {
        const int ring = fourier_ring(spec, near(frequency[p]), near(frequency[q]));
        ASSERT_EQ(rings.slot[p * spec.n + q], ring == kNone ? spec.rings : ring) << p << " " << q;
      }
    }
  }
  for (const MetricSpec& spec : specs(Transform::walsh_sequency)) {
    SCOPED_TRACE(spec.text());
    const RingTables rings(spec);
    const WalshTables walsh(spec);
    for (int p = 0; p < spec.n; ++p) {
      for (int q = 0; q < spec.n; ++q) {
        const int ring = walsh_ring(spec, walsh.index[p], walsh.index[q]);
        ASSERT_EQ(rings.slot[p * spec.n + q], ring == kNone ? spec.rings : ring) << p << " " << q;
      }
    }
  }
}

// A plane of ones has a mean of one in every ring, as the kernels sum it: fft 2 N^2 F over half of
// the plane, Walsh N^2 W over all of it.
TEST(RingTables, FactorsMakeSumsMeans) {
  for (const Transform transform : {Transform::fft, Transform::walsh_sequency}) {
    for (const MetricSpec& spec : specs(transform)) {
      SCOPED_TRACE(spec.text());
      const RingTables rings(spec);
      std::vector<double> sums(spec.rings + 1, 0);
      const bool is_fourier = transform == Transform::fft;
      const double whole = (is_fourier ? 2.0 : 1.0) * spec.n * spec.n;
      const double one = spec.power ? whole * whole : whole;
      for (const std::uint8_t slot : rings.slot) sums[slot] += is_fourier ? one / 2 : one;
      for (int k = 0; k < spec.rings; ++k) EXPECT_NEAR(sums[k] * rings.factor[k], 1, 1e-12) << k;
    }
  }
}

template <int kLanes, class T>
void expect_runs(const MetricSpec& spec, const StripRings<T>& rings) {
  const int half = spec.n / 2;
  for (int strip = 0; strip * kLanes < half; ++strip) {
    for (int k = 0; k < spec.rings; ++k) {
      const auto run = rings.template runs<kLanes>(strip)[k];
      EXPECT_EQ((run.end - run.first) % 2, 0);
      EXPECT_LE(run.end, half + 2);
      int first = half + 1, last = -1;
      for (int u = 0; u <= half; ++u) {
        for (int v = 1 + strip * kLanes; v <= std::min(half, (strip + 1) * kLanes); ++v) {
          if (fourier_ring(spec, u, v) != k) continue;
          first = std::min(first, u), last = u;
        }
      }
      if (last < 0) {
        EXPECT_EQ(run.first, run.end);
      } else {
        EXPECT_EQ(run.first, first);
        EXPECT_TRUE(run.end == last + 1 || run.end == last + 2) << run.end << ", last " << last;
      }
    }
  }
}

TEST(RingTables, StripsMeetEveryCoefficientOfARing) {
  for (const MetricSpec& spec : specs(Transform::fft)) {
    if (spec.n < 32) continue;  // the smaller ones have no strips
    SCOPED_TRACE(spec.text());
    const StripRings<float> rings(spec);
    const StripRings<double> in_double(spec);
    const int half = spec.n / 2;
    for (int u = 0; u <= half + 1; ++u) {
      for (int v = 1; v <= half; ++v) {
        const int ring = u <= half ? fourier_ring(spec, u, v) : kNone;
        ASSERT_EQ(rings.row(u)[v - 1], static_cast<float>(ring)) << u << " " << v;
        ASSERT_EQ(in_double.row(u)[v - 1], ring) << u << " " << v;
      }
    }
    expect_runs<16>(spec, rings);
    expect_runs<8>(spec, rings);
    expect_runs<4>(spec, rings);
    expect_runs<2>(spec, in_double);
    for (int u = 0; u <= half; ++u) {
      for (int k = 0; k < spec.rings; ++k) {
        const auto run = rings.zero_row()[k];
        EXPECT_EQ(run.first <= u && u < run.end, fourier_ring(spec, u, 0) == k) << u << " " << k;
      }
    }
  }
}

/// What the layers of a plan move: [ring][row v][column u], how often it counts.
template <class T>
std::vector<double> moved(const MetricSpec& spec, const RingLayers<T>& layers) {
  constexpr int kLanes = RingLayers<T>::kLanes;
  const int half = spec.n / 2, side = half + 1;
  std::vector<double> counts(spec.rings * side * side);
  for (int strip = 0; strip * kLanes < half; ++strip) {
    for (int k = 0; k < spec.rings; k += kLanes) {
      for (const auto& layer : layers.layers(strip, k)) {
        EXPECT_EQ((layer.end - layer.first) % 2, 0);
        EXPECT_LE(layer.end, half + 2);
        for (int u = layer.first; u < layer.end; ++u) {
          const auto& move = layers.moves(layer)[u - layer.first];
          for (int lane = 0; lane < kLanes; ++lane) {
            if (move.share[lane] == 0) continue;
            const int v = 1 + strip * kLanes + static_cast<int>(move.from[lane]);
            EXPECT_LT(k + lane, spec.rings);
            EXPECT_LE(std::max(u, v), half);
            counts[((k + lane) * side + v) * side + u] += move.share[lane];
          }
        }
      }
    }
  }
  return counts;
}

template <class T>
void expect_layers(const MetricSpec& spec) {
  const auto counts = moved(spec, RingLayers<T>(spec));
  const int half = spec.n / 2, side = half + 1;
  for (int k = 0; k < spec.rings; ++k) {
    for (int v = 1; v <= half; ++v) {
      for (int u = 0; u <= half; ++u) {
        const double share = v == half ? 0.5 : 1;
        ASSERT_EQ(counts[(k * side + v) * side + u], fourier_ring(spec, u, v) == k ? share : 0)
            << "ring " << k << " at " << u << " " << v;
      }
    }
  }
}

TEST(RingTables, LayersMoveEveryCoefficientOfARingOnce) {
  for (const MetricSpec& spec : specs(Transform::fft)) {
    SCOPED_TRACE(spec.text());
    expect_layers<float>(spec);
    expect_layers<double>(spec);
  }
}

TEST(RingTables, NarrowRingsAloneHaveLayers) {
  const auto has_layers = [](const char* text) {
    return StripRings<float>(MetricSpec::parse(text)).layers() != nullptr;
  };
  EXPECT_TRUE(has_layers("fft:32:rings=16"));
  EXPECT_FALSE(has_layers("fft:64:power:rings=32"));
  EXPECT_TRUE(has_layers("fft:32:band=0.2-0.7:rings=16"));
  EXPECT_FALSE(has_layers("fft:32:rings=8"));
  EXPECT_FALSE(has_layers("fft:64:rings=16"));
  EXPECT_FALSE(has_layers("fft:128:band=0.1-0.35:rings=32"));
}

TEST(RingTables, SequencyRunsFollowEachOther) {
  for (const MetricSpec& spec : specs(Transform::walsh_sequency)) {
    SCOPED_TRACE(spec.text());
    const SequencyRings rings(spec);
    const WalshTables walsh(spec);
    ASSERT_EQ(rings.edges, spec.rings + 1);
    for (int p = 0; p < spec.n; ++p) {
      for (int j = 0; j < spec.n; ++j) {
        int found = kNone;
        for (int k = 0; k < spec.rings; ++k) {
          const int first = rings.start[k * spec.n + p], end = rings.start[(k + 1) * spec.n + p];
          if (first <= j && j < end) found = k;
        }
        ASSERT_EQ(found, walsh_ring(spec, walsh.index[p], j)) << p << " " << j;
      }
    }
  }
}

/// How many times the even noise |dF| each ring may have, from the documentation.
std::vector<double> concentrations(const MetricSpec& spec) {
  std::vector<double> all, cross(spec.rings), centre(spec.rings), plane(spec.rings);
  for (int v = -spec.n / 2; v < spec.n / 2; ++v) {
    for (int u = -spec.n / 2; u < spec.n / 2; ++u) {
      const int ring = fourier_ring(spec, u, v);
      if (ring == kNone) continue;
      const int least = std::min(std::abs(u), std::abs(v)),
                most = std::max(std::abs(u), std::abs(v));
      ++plane[ring];
      if (least <= 1) ++cross[ring];
      if (most <= 1) ++centre[ring];
    }
  }
  for (int k = 0; k < spec.rings; ++k) {
    const double lines = 0.9 * std::sqrt(spec.n * cross[k] / plane[k]);
    all.push_back(
        std::max({1.0, lines, (spec.power ? 0.25 : 0.5) * spec.n * centre[k] / plane[k]}));
  }
  return all;
}

/// The rule of the documentation, computed the long way round. noise: |dF| in the ring.
bool is_allowed(const MetricSpec& spec, double value, double noise) {
  const double allowed = 0.9e-5 * (value + test::quantisation(spec));
  return (spec.power ? 2 * noise * std::sqrt(value) + noise * noise : noise) <= allowed;
}

/// SUM |2 N^2 F|^2 of a picture whose noise in float is |dF|.
double energy_of(const MetricSpec& spec, double noise) {
  const double n = spec.n, contrast = noise * n * n / (2.0 / 16777216);
  return 4 * n * n * contrast * contrast;
}

TEST(RingDoubt, IsTheRuleOfTheDocumentation) {
  test::SplitMix64 random(11);
  int allowed = 0, in_doubt = 0;
  for (const char* text : {"fft:32:hann:rings=16", "fft:64:hann:power:rings=16",
                           "fft:16:none:power:rings=3", "fft:128:tukey=0.3:rings=5"}) {
    const MetricSpec spec = MetricSpec::parse(text);
    const RingDoubt doubt(spec);
    const auto concentration = concentrations(spec);
    const double grain = test::quantisation(spec);
    for (int i = 0; i < 20000; ++i) {
      const auto exponent = [&] { return static_cast<double>(random.below(1000)) / 1000; };
      std::vector<double> values;
      const double steps = 8 * exponent();
      for (int k = 0; k < spec.rings; ++k)
        values.push_back(grain * std::pow(10, steps * exponent() - 2));
      const double root = spec.power ? std::sqrt(grain) : grain;
      const double noise = root * 1e-5 * std::pow(10, 6 * exponent() - 2);
      bool expected = true;
      for (int k = 0; k < spec.rings; ++k)
        expected = expected && is_allowed(spec, values[k], noise * concentration[k]);
      (expected ? allowed : in_doubt) += 1;
      ASSERT_EQ(doubt.about(values, energy_of(spec, noise)), !expected)
          << text << " draw " << i << " of seed 11";
    }
  }
  EXPECT_GT(allowed, 1000);
  EXPECT_GT(in_doubt, 1000);
}

TEST(RingDoubt, IsAboutWhatIsNoNumber) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const char* text : {"fft:32:hann:rings=3", "fft:32:hann:power:rings=3"}) {
    const RingDoubt doubt(MetricSpec::parse(text));
    EXPECT_FALSE(doubt.about(std::vector<double>{0, 0, 0}, 0)) << "black windows are exact";
    for (const double odd : {kNaN, kInfinity}) {
      EXPECT_TRUE(doubt.about(std::vector<double>{odd, 1, 1}, 1));
      EXPECT_TRUE(doubt.about(std::vector<double>{1, 1, odd}, 1));
      EXPECT_TRUE(doubt.about(std::vector<double>{1, 1, 1}, odd));
    }
  }
}

/// Pictures of the greatest contrast whose spectra are nearly empty, and bright ones with hardly
/// any: what float gets wrong if nobody doubts it.
std::vector<test::Pixels> hard_pictures(int n) {
  std::vector<test::Pixels> pictures;
  const auto draw = [&](auto&& grey) {
    test::Pixels pixels = test::make_pixels("zero", 8, n, n, 0);
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) pixels.at(x, y) = static_cast<std::uint16_t>(grey(x, y));
    }
    pictures.push_back(std::move(pixels));
  };
  draw([&](int x, int) { return x < n / 2 ? 0 : 255; });
  draw([&](int, int y) { return y < n / 2 ? 255 : 0; });
  draw([&](int x, int y) { return (x / 2 + y / 2) % 2 * 255; });
  draw([&](int x, int y) { return (x + y) % 4 < 2 ? 255 : 0; });
  draw([&](int x, int) { return 255 * x / (n - 1); });
  draw([&](int x, int y) { return x == n / 2 && y == n / 2 ? 255 : 254; });
  draw([&](int x, int y) {
    return std::lround(127.5 + 127.5 * std::cos(2 * std::numbers::pi * (x + y) / n));
  });
  draw([&](int x, int y) { return std::abs(x - n / 2) + std::abs(y - n / 2) < n / 4 ? 255 : 3; });
  return pictures;
}

class Rings : public test::EveryCpuDevice {};
FATHOM_EVERY_CPU_DEVICE(Rings);

TEST_P(Rings, OfHardPicturesAreWithinTheTolerance) {
  const auto device = open(1);
  const auto oracle = test::backend_called("reference").open(0, {});
  for (const char* text :
       {"fft:8:hann:rings=4", "fft:16:hann:rings=8", "fft:32:hann:rings=16", "fft:32:none:rings=16",
        "fft:32:hann:power:rings=16", "fft:64:hann:rings=16", "fft:64:hann:power:rings=32",
        "fft:64:tukey=0.3:power:rings=8", "fft:32:hann:power:band=0.2-0.7:rings=16"}) {
    const MetricSpec spec = MetricSpec::parse(text);
    const auto plan = device->plan(spec, 1), exact = oracle->plan(spec, 1);
    const double grain = test::quantisation(spec);
    int number = 0;
    for (const test::Pixels& pixels : hard_pictures(spec.n)) {
      const Frame frame = test::to_frame(pixels);
      const std::vector<Window> window = {{0, 0, spec.n}};
      std::vector<double> values(spec.rings), expected(spec.rings);
      plan->score(frame, window, values);
      exact->score(frame, window, expected);
      for (int k = 0; k < spec.rings; ++k) {
        EXPECT_TRUE(test::ring_matches(values[k], expected[k], spec, grain, 1e-5))
            << text << ", picture " << number << ", ring " << k;
      }
      ++number;
    }
  }
}

}  // namespace
}  // namespace fathom::cpu
