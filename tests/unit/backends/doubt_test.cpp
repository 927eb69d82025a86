// SPDX-License-Identifier: Apache-2.0
// When a score in float is not trusted: the formulas of docs/metrics.md, "When float is not
// enough", and what they say of pictures.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "backends/cpu/tables.hpp"
#include "engine/tables.hpp"
#include "tests/unit/backends/cpu_devices.hpp"

namespace fathom::cpu {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<MetricSpec> specs(const std::vector<int>& sides) {
  std::vector<MetricSpec> all;
  for (const int n : sides) {
    for (const Taper taper : {Taper::none(), Taper::hann(), Taper{0.25}, Taper{0.6}}) {
      for (const bool power : {false, true}) all.push_back({Transform::fft, n, taper, power, {}});
    }
  }
  return all;
}

/// What a kernel measures, from the oracle's spectrum.
struct Measured {
  double score, energy, bright;
};

Measured measure(const MetricSpec& spec, const test::Pixels& pixels) {
  const int n = spec.n;
  const Frame frame = test::to_frame(pixels);
  const auto plan = test::backend_called("reference").open(0, {})->plan(spec, 1);
  std::vector<std::complex<double>> spectrum(static_cast<std::size_t>(n) * n);
  plan->spectrum(frame, {0, 0, n}, spectrum);
  const auto flat = tables::taper_spectrum(spec.taper, n);
  const auto w = [&](int k) { return flat[(k + n) % n]; };
  const double zero = spectrum[static_cast<std::size_t>(n / 2) * n + n / 2].real();
  const double brightness = zero / std::norm(w(0));
  Measured measured{plan->score(frame, {0, 0, n}), 0, 2 * n * w(0).real() * brightness};
  for (int v = -n / 2; v < n / 2; ++v) {
    for (int u = -n / 2; u < n / 2; ++u) {
      const auto f = spectrum[static_cast<std::size_t>(v + n / 2) * n + u + n / 2];
      measured.energy += std::norm(2.0 * n * n * (f - brightness * w(u) * w(v)));
    }
  }
  return measured;
}

bool is_doubtful(const MetricSpec& spec, const test::Pixels& pixels) {
  const Measured measured = measure(spec, pixels);
  return Doubt(spec).about(measured.score, measured.energy, measured.bright);
}

template <class Grey>
test::Pixels drawn(int n, const Grey& grey) {
  test::Pixels pixels = test::make_pixels("zero", 8, n, n, 0);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) pixels.at(x, y) = static_cast<std::uint16_t>(grey(x, y));
  }
  return pixels;
}

TEST(Doubt, IsAboutPicturesWithNearlyEmptySpectra) {
  for (const MetricSpec& spec : specs({64, 128})) {
    if (spec.power) continue;  // weighs what a picture has more than the noise beside it
    SCOPED_TRACE(spec.text());
    const int n = spec.n;
    EXPECT_TRUE(is_doubtful(spec, drawn(n, [](int x, int) { return x; }))) << "a ramp";
    EXPECT_TRUE(is_doubtful(spec, drawn(n, [](int, int y) { return 255 - y; }))) << "a ramp";
    EXPECT_TRUE(is_doubtful(spec, drawn(n, [&](int x, int) { return x < n / 2 ? 60 : 61; })))
        << "an edge of one grey level";
    EXPECT_TRUE(is_doubtful(spec, drawn(n, [](int, int) { return 90; }))) << "nothing but grey";
  }
}

TEST(Doubt, IsAboutSmoothPictures) {
  for (const MetricSpec& spec : specs({128})) {
    if (spec.power || spec.taper != Taper::hann()) continue;  // else the frame's edges are sharp
    const auto spot = drawn(spec.n, [&](int x, int y) {
      const double dx = x - (spec.n - 1) / 2.0, dy = y - (spec.n - 1) / 2.0;
      return 250 * std::exp(-(dx * dx + dy * dy) * 8 / (spec.n * spec.n));
    });
    EXPECT_TRUE(is_doubtful(spec, spot)) << spec.text();
  }
}

TEST(Doubt, IsNotAboutTextureAndNoise) {
  for (const MetricSpec& spec : specs({8, 32, 64, 128})) {
    for (const char* content : {"random", "binary", "natural"}) {
      const auto pixels = test::make_pixels(content, 8, spec.n, spec.n, 3);
      EXPECT_FALSE(is_doubtful(spec, pixels)) << spec.text() << ", " << content;
    }
    // Dark and hardly any contrast: what matters is how it is spread.
    test::SplitMix64 noise(5);
    const auto faint = drawn(spec.n, [&](int, int) { return static_cast<int>(noise.below(3)); });
    EXPECT_FALSE(is_doubtful(spec, faint)) << spec.text() << ", faint noise";
  }
}

TEST(Doubt, IsNotAboutBlackWindows) {
  for (const MetricSpec& spec : specs({8, 64, 512})) {
    EXPECT_FALSE(Doubt(spec).about(0, 0, 0)) << spec.text();
  }
}

TEST(Doubt, IsAboutWhatIsNoNumber) {
  for (const MetricSpec& spec : specs({8, 64})) {
    const Doubt doubt(spec);
    EXPECT_TRUE(doubt.about(kNaN, 1, 1));
    EXPECT_TRUE(doubt.about(1, kNaN, 1));
    EXPECT_TRUE(doubt.about(1, 1, kNaN));
    EXPECT_TRUE(doubt.about(kNaN, kNaN, kNaN));
    EXPECT_TRUE(doubt.about(1, kInfinity, 1));
  }
}

// The limit as the documentation has it, computed the long way round.
TEST(Doubt, BeginsWhereTheNoiseScoresATolerance) {
  for (const MetricSpec& spec : specs({8, 16, 32, 64, 128, 256, 512})) {
    SCOPED_TRACE(spec.text());
    const double n = spec.n, rounding = 2.0 / 16777216, tolerance = 2e-6;
    double impulse = 0, touched = 0;  // the score of a pixel of one grey level; SUM |W|
    for (int v = -spec.n / 2; v < spec.n / 2; ++v) {
      for (int u = -spec.n / 2; u < spec.n / 2; ++u) {
        impulse += 0.5 * (u * u + v * v) * std::pow(n, spec.power ? -4 : -2) / std::pow(n, 4);
      }
    }
    const auto flat = tables::taper_spectrum(spec.taper, spec.n);
    for (const auto& w : flat) touched += std::abs(w);
    const double grey = 77;
    for (const double contrast : {0.0, 1.0, 300.0}) {  // root of the sum of squares
      const double of_brightness = 0.5 * grey * touched * std::sqrt(n);
      const double noise = rounding * std::hypot(contrast, of_brightness);
      const double limit = spec.power ? noise * noise * impulse / (tolerance * tolerance)
                                      : noise * impulse / tolerance;
      const double energy = contrast * contrast * 4 * n * n, bright = 2 * n * flat[0].real() * grey;
      EXPECT_TRUE(Doubt(spec).about(limit * (1 - 1e-9), energy, bright));
      EXPECT_FALSE(Doubt(spec).about(limit * (1 + 1e-9), energy, bright));
    }
  }
}

// Brightness is rounded in every row that the taper's transform touches, with long lever arms in
// rows far out. Twice the sum over all rows as if they were near v = 0 must cover that.
TEST(Doubt, CoversTheBrightnessOfEveryTaper) {
  for (const int n : {8, 16, 32, 64, 128, 256, 512}) {
    for (double fraction = 0; fraction <= 1; fraction += 1 / 64.0) {
      const auto flat = tables::taper_spectrum(Taper{fraction}, n);
      const auto arms = tables::lever_arms(Transform::fft, n);
      double sum_of_arms = 0, touched = 0, weighted = 0;
      for (const double arm : arms) sum_of_arms += arm;
      for (int v = 0; v < n; ++v) {
        touched += std::abs(flat[v]);
        weighted += std::abs(flat[v]) * (1 + n * arms[v] / sum_of_arms);
      }
      EXPECT_LE(weighted, 2 * touched) << n << ", tukey=" << fraction;
    }
  }
}

class DoubtOfKernels : public test::EveryCpuDevice {};
FATHOM_EVERY_CPU_DEVICE(DoubtOfKernels);

// 16-bit pixels are computed in double, so a score that is the same to the last bit was, too.
TEST_P(DoubtOfKernels, DecidesWhatIsComputedInDouble) {
  for (const MetricSpec& spec : specs({64, 128})) {
    if (spec.power) continue;
    SCOPED_TRACE(spec.text());
    const auto plan = open(1)->plan(spec, 1);
    const auto is_in_double = [&](test::Pixels pixels) {
      const double score = plan->score(test::to_frame(pixels), {0, 0, spec.n});
      pixels.bits = 16;
      return score == plan->score(test::to_frame(pixels), {0, 0, spec.n});
    };
    EXPECT_TRUE(is_in_double(drawn(spec.n, [](int x, int) { return x; })));
    EXPECT_TRUE(is_in_double(drawn(spec.n, [](int, int y) { return 255 - y; })));
    EXPECT_TRUE(is_in_double(drawn(spec.n, [](int x, int y) { return (x + y) / 2 + 1; })));
    EXPECT_FALSE(is_in_double(test::make_pixels("random", 8, spec.n, spec.n, 3)));
    EXPECT_FALSE(is_in_double(test::make_pixels("natural", 8, spec.n, spec.n, 3)));
  }
}

}  // namespace
}  // namespace fathom::cpu
